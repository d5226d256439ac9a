// SPDX-License-Identifier: Apache-2.0
#include "servo/record/black_box.hpp"

#include <sys/wait.h>
#include <unistd.h>

#include <algorithm>
#include <catch2/catch.hpp>
#include <filesystem>
#include <fstream>
#include <memory>

#include "tests/servo/support/shape_asset.hpp"

namespace black_box_test {

using namespace spm;
using namespace spm::servo;
using spm::test::TemporaryFolder;

namespace {

RecordingHeader header_of_one() {
  RecordingHeader header;
  header.rate_hz = 1000;
  header.devices.resize(1);
  header.devices[0].name = "sim";
  for (std::size_t i = 0; i < force_off_count; ++i) {
    header.causes.emplace_back(to_string(static_cast<ForceOff>(i)));
  }
  return header;
}

std::unique_ptr<BlackBoxMemory> memory_of_one() {
  auto memory = BlackBoxMemory::make(BlackBoxMemory::bytes_for(1, 1000, BlackBox::kept_seconds));
  REQUIRE(memory);
  return std::move(*memory);
}

/// A box that was shown `ticks` ticks; `cause_at` tells each tick's cause.
template <class CauseAt>
void show(BlackBox& box, std::uint64_t ticks, const CauseAt& cause_at) {
  RecordingRow row;
  for (row.tick = 0; row.tick < ticks; ++row.tick) {
    row.cause = static_cast<std::uint8_t>(cause_at(row.tick));
    std::string part;
    append_part(part, row);
    box.take(row, part, header_of_one);
  }
  box.finish();
}

}  // namespace

TEST_CASE("A fault leaves at least ten seconds about it in a file, the half second after it too") {
  const TemporaryFolder folder;
  const std::string path = folder.file("made/box.spmrec");
  const auto memory = memory_of_one();
  BlackBox box(path, *memory, [](const std::string&) {});
  show(box, 20000,
       [](std::uint64_t tick) { return tick >= 15000 ? ForceOff::asset_lost : ForceOff::none; });
  REQUIRE(box.written() == 1);
  const auto kept = read_recording(path);
  REQUIRE(kept);
  REQUIRE(kept->rows.size() >= 10000);
  CHECK(kept->rows.size() <= 20000);
  CHECK(kept->rows.front().tick == 15500 - kept->rows.size());
  CHECK(kept->rows.back().tick == 15499);
  CHECK(kept->header.causes[kept->rows.back().cause] == "asset_lost");
}

TEST_CASE("A fault right before the end is written at the end") {
  const TemporaryFolder folder;
  const std::string path = folder.file("box.spmrec");
  const auto memory = memory_of_one();
  BlackBox box(path, *memory, [](const std::string&) {});
  show(box, 100,
       [](std::uint64_t tick) { return tick >= 90 ? ForceOff::device_gone : ForceOff::none; });
  const auto kept = read_recording(path);
  REQUIRE(kept);
  CHECK(kept->rows.size() == 100);
}

TEST_CASE("Starting, stopping and homing are no faults") {
  const TemporaryFolder folder;
  const std::string path = folder.file("box.spmrec");
  const auto memory = memory_of_one();
  BlackBox box(path, *memory, [](const std::string&) {});
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
  const auto memory = memory_of_one();
  BlackBox box(folder.file("box.spmrec"), *memory, [](const std::string&) {});
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
  const auto memory = memory_of_one();
  BlackBox box(folder.file("file/box.spmrec"), *memory,
               [&](const std::string& warning) { warnings.push_back(warning); });
  show(box, 2000,
       [](std::uint64_t tick) { return tick == 1000 ? ForceOff::not_a_number : ForceOff::none; });
  CHECK(box.written() == 0);
  REQUIRE(warnings.size() == 1);
  CHECK(warnings[0].find("could not be kept") != std::string::npos);
}

TEST_CASE("At any moment the memory holds the last ten seconds, whatever process writes them out") {
  const TemporaryFolder folder;
  const auto memory = memory_of_one();
  CHECK(memory->empty());
  BlackBox box(folder.file("fault.spmrec"), *memory, [](const std::string&) {});
  for (const std::uint64_t ticks : {1U, 9999U, 10001U, 15000U, 20001U, 35000U}) {
    show(box, ticks, [](std::uint64_t) { return ForceOff::none; });
    const std::string path = folder.file("made/killed.spmrec");
    const pid_t child = fork();
    if (child == 0) _exit(memory->write(path) ? 0 : 1);
    int status = 1;
    waitpid(child, &status, 0);
    REQUIRE(status == 0);
    const auto kept = read_recording(path);
    REQUIRE(kept);
    REQUIRE(kept->rows.back().tick == ticks - 1);
    std::size_t in_a_row = 1;
    while (in_a_row < kept->rows.size() && in_a_row < ticks &&
           kept->rows[kept->rows.size() - 1 - in_a_row].tick == ticks - 1 - in_a_row) {
      ++in_a_row;
    }
    CHECK(in_a_row >= std::min<std::uint64_t>(ticks, 10000));
  }
}

TEST_CASE(
    "Faults within a minute leave one file, later ones another, of the daemon's name and time") {
  const TemporaryFolder folder;
  const auto memory = memory_of_one();
  BlackBox box(folder.file("made/box-desk-*.spmrec"), *memory, [](const std::string&) {});
  // Twice a second, for two and a half minutes.
  show(box, 150'000, [](std::uint64_t tick) {
    return tick % 500 < 100 ? ForceOff::device_silent : ForceOff::none;
  });
  CHECK(box.written() == 3);
  int files = 0;
  for (const auto& entry : std::filesystem::directory_iterator(folder.file("made"))) {
    CHECK(entry.path().filename().string().starts_with("box-desk-2"));
    CHECK(read_recording(entry.path().string()));
    ++files;
  }
  CHECK(files == 3);
}

TEST_CASE("Of the black boxes of a daemon the newest are kept, and no other's are touched") {
  const TemporaryFolder folder;
  const auto memory = memory_of_one();
  BlackBox box(folder.file("unused"), *memory, [](const std::string&) {});
  show(box, 10, [](std::uint64_t) { return ForceOff::none; });
  const std::string other = folder.file("box-desk-two-2020-01-01T00-00-00Z.spmrec");
  std::ofstream(other) << "another daemon's";
  const std::string pattern = folder.file("box-desk-*.spmrec");
  constexpr std::time_t begin = 1'800'000'000;
  std::vector<std::string> written;
  for (std::time_t i = 0; i < 8; ++i) {
    const auto file = write_black_box(*memory, pattern, begin + i / 2);
    REQUIRE(file);
    written.push_back(*file);
  }
  CHECK(written[0] == folder.file("box-desk-2027-01-15T08-00-00Z.spmrec"));
  CHECK(written[1] == folder.file("box-desk-2027-01-15T08-00-00Z_2.spmrec"));
  for (std::size_t i = 0; i < written.size(); ++i) {
    CAPTURE(written[i]);
    CHECK(std::filesystem::exists(written[i]) == (i + black_boxes_kept >= written.size()));
  }
  CHECK(std::filesystem::exists(other));
  // A file that is named is that file.
  CHECK(write_black_box(*memory, folder.file("mine.spmrec")) == folder.file("mine.spmrec"));
}

TEST_CASE("A memory that is full of changes keeps those that came last") {
  const TemporaryFolder folder;
  auto memory = BlackBoxMemory::make(8192);
  REQUIRE(memory);
  BlackBox box(folder.file("box.spmrec"), **memory, [](const std::string&) {});
  for (std::uint64_t tick = 0; tick < 1000; ++tick) {
    RecordedChange change;
    change.tick = tick;
    change.pose = {static_cast<double>(tick), 0, 0, 1, 0, 0, 0};
    std::string part;
    append_part(part, change);
    box.take(part, header_of_one);
  }
  REQUIRE((*memory)->write(folder.file("box.spmrec")));
  const auto kept = read_recording(folder.file("box.spmrec"));
  REQUIRE(kept);
  REQUIRE(kept->changes.size() > 50);
  CHECK(kept->changes.back().tick == 999);
  CHECK(kept->changes.front().tick == 1000 - kept->changes.size());
}

TEST_CASE("A scene that does not fit into the memory is told once") {
  const TemporaryFolder folder;
  auto memory = BlackBoxMemory::make(4096);
  REQUIRE(memory);
  int warnings = 0;
  BlackBox box(folder.file("box.spmrec"), **memory, [&](const std::string&) { ++warnings; });
  RecordingHeader large = header_of_one();
  large.scene = std::string(10000, ' ');
  for (RecordingRow row; row.tick < 100; ++row.tick) {
    std::string part;
    append_part(part, row);
    box.take(row, part, [&] { return large; });
  }
  CHECK(warnings == 1);
}

}  // namespace black_box_test
