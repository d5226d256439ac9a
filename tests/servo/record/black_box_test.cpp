// SPDX-License-Identifier: Apache-2.0
#include "servo/record/black_box.hpp"

#include <catch2/catch.hpp>
#include <filesystem>
#include <fstream>

#include "tests/servo/support/shape_asset.hpp"

namespace black_box_test {

using namespace spm;
using namespace spm::servo;
using spm::test::TemporaryFolder;

namespace {

RecordingHeader header_of_one() {
  RecordingHeader header;
  header.rate_hz = 1000;
  header.devices = {{"sim", 0}};
  for (std::size_t i = 0; i < force_off_count; ++i) {
    header.causes.emplace_back(to_string(static_cast<ForceOff>(i)));
  }
  return header;
}

/// A box that was shown `ticks` ticks; `cause_at` tells each tick's cause.
template <class CauseAt>
void show(BlackBox& box, std::uint64_t ticks, const CauseAt& cause_at) {
  RecordingRow row;
  for (row.tick = 0; row.tick < ticks; ++row.tick) {
    row.cause = static_cast<std::uint8_t>(cause_at(row.tick));
    box.take(row);
  }
  box.finish();
}

}  // namespace

TEST_CASE("A fault leaves the ten seconds about it in a file, the half second after it included") {
  const TemporaryFolder folder;
  const std::string path = folder.file("made/box.spmrec");
  BlackBox box(path, header_of_one(), [](const std::string&) {});
  show(box, 20000,
       [](std::uint64_t tick) { return tick >= 15000 ? ForceOff::asset_lost : ForceOff::none; });
  REQUIRE(box.written() == 1);
  const auto kept = read_recording(path);
  REQUIRE(kept);
  REQUIRE(kept->rows.size() == 10000);
  CHECK(kept->rows.front().tick == 5500);
  CHECK(kept->rows.back().tick == 15499);
  CHECK(kept->header.causes[kept->rows.back().cause] == "asset_lost");
}

TEST_CASE("A fault right before the end is written at the end") {
  const TemporaryFolder folder;
  const std::string path = folder.file("box.spmrec");
  BlackBox box(path, header_of_one(), [](const std::string&) {});
  show(box, 100,
       [](std::uint64_t tick) { return tick >= 90 ? ForceOff::device_gone : ForceOff::none; });
  const auto kept = read_recording(path);
  REQUIRE(kept);
  CHECK(kept->rows.size() == 100);
}

TEST_CASE("Starting, stopping and homing are no faults") {
  const TemporaryFolder folder;
  const std::string path = folder.file("box.spmrec");
  BlackBox box(path, header_of_one(), [](const std::string&) {});
  show(box, 3000, [](std::uint64_t tick) {
    if (tick < 100) return ForceOff::starting;
    if (tick < 200) return ForceOff::not_homed;
    return tick == 2999 ? ForceOff::stopping : ForceOff::none;
  });
  CHECK(box.written() == 0);
  CHECK_FALSE(std::filesystem::exists(path));
}

TEST_CASE("A device that is not there yet is no fault, one that goes is") {
  const TemporaryFolder folder;
  BlackBox box(folder.file("box.spmrec"), header_of_one(), [](const std::string&) {});
  show(box, 2000,
       [](std::uint64_t tick) { return tick < 1000 ? ForceOff::device_gone : ForceOff::none; });
  CHECK(box.written() == 0);
  show(box, 2000,
       [](std::uint64_t tick) { return tick > 1000 ? ForceOff::device_gone : ForceOff::none; });
  CHECK(box.written() == 1);
}

TEST_CASE("Where the black box cannot be written, a warning says so and no more") {
  const TemporaryFolder folder;
  std::ofstream(folder.file("file")) << "in the way";
  std::vector<std::string> warnings;
  BlackBox box(folder.file("file/box.spmrec"), header_of_one(),
               [&](const std::string& warning) { warnings.push_back(warning); });
  show(box, 2000,
       [](std::uint64_t tick) { return tick == 1000 ? ForceOff::not_a_number : ForceOff::none; });
  CHECK(box.written() == 0);
  REQUIRE(warnings.size() == 1);
  CHECK(warnings[0].find("could not be kept") != std::string::npos);
}

}  // namespace black_box_test
