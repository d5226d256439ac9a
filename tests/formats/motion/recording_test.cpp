// SPDX-License-Identifier: Apache-2.0
#include "formats/motion/recording.hpp"

#include <catch2/catch.hpp>
#include <cstring>
#include <filesystem>
#include <fstream>
#include <random>
#include <sstream>

#include "tests/formats/support/synthetic_asset.hpp"

namespace recording_test {

namespace {

using namespace spm;
using namespace spm::test;

RecordingHeader header_of_two() {
  RecordingHeader header;
  header.spm_version = "1.2.3";
  header.instruction_set = "AVX2";
  header.rate_hz = 2000;
  header.devices = {{"falcon", 6.4e-5, 3000}, {"sim", 2e-5}};
  header.causes = {"none", "starting"};
  header.assets = {"abc", "def"};
  return header;
}

RecordingRow row_of(std::uint64_t tick, std::mt19937_64& random) {
  std::uniform_real_distribution<double> number(-1, 1);
  RecordingRow row;
  row.tick = tick;
  for (auto* vector : {&row.position, &row.wanted, &row.sent}) {
    for (double& value : *vector) value = number(random);
  }
  row.depth = number(random);
  row.device = static_cast<std::uint16_t>(tick % 2);
  row.cause = static_cast<std::uint8_t>(tick % 3 == 0);
  row.flags = recorded_contact;
  return row;
}

std::string recording_of(const TemporaryFolder& folder, std::size_t rows) {
  std::mt19937_64 random(5);
  auto writer = RecordingWriter::create(folder.path("a.spmrec"), header_of_two());
  REQUIRE(writer);
  for (std::size_t i = 0; i < rows; ++i) writer->append(row_of(i, random));
  REQUIRE(writer->commit());
  return folder.path("a.spmrec");
}

std::string content(const std::string& path) {
  std::ifstream file(path, std::ios::binary);
  std::ostringstream text;
  text << file.rdbuf();
  return text.str();
}

}  // namespace

TEST_CASE("A recording is read back bit by bit, however many rows it has") {
  for (const std::size_t rows : {0U, 1U, 629U, 5000U}) {
    const TemporaryFolder folder;
    const std::string path = recording_of(folder, rows);
    REQUIRE(is_recording(path));
    const auto recording = read_recording(path);
    REQUIRE(recording);
    CHECK(recording->header.spm_version == "1.2.3");
    CHECK(recording->header.instruction_set == "AVX2");
    CHECK(recording->header.rate_hz == 2000);
    CHECK(recording->header.devices[1].encoder_step == 2e-5);
    CHECK(recording->header.devices[0].stiffness_cap == 3000);
    CHECK(recording->header.devices[1].stiffness_cap == std::numeric_limits<double>::infinity());
    CHECK(recording->header.assets == header_of_two().assets);
    REQUIRE(recording->rows.size() == rows);
    std::mt19937_64 random(5);
    for (std::size_t i = 0; i < rows; ++i) {
      const RecordingRow wanted = row_of(i, random);
      REQUIRE(std::memcmp(&recording->rows[i], &wanted, sizeof wanted) == 0);
    }
  }
}

TEST_CASE("A recording with any byte changed, or cut anywhere, is refused with a cause") {
  const TemporaryFolder folder;
  const std::string whole = content(recording_of(folder, 20));
  const std::string path = folder.path("b.spmrec");
  const auto refused = [&](const std::string& bytes) {
    std::ofstream(path, std::ios::binary).write(bytes.data(), static_cast<long>(bytes.size()));
    const auto recording = read_recording(path);
    REQUIRE_FALSE(recording);
    CHECK(recording.error().code == ExitCode::invalid_input);
    CHECK(recording.error().message.starts_with(path + ": "));
  };
  for (std::size_t at = 0; at < whole.size(); at += 13) {
    std::string changed = whole;
    changed[at] = static_cast<char>(changed[at] ^ 0x20);
    refused(changed);
  }
  for (std::size_t size = 0; size < whole.size(); size += 17) refused(whole.substr(0, size));
  refused(whole + '\0');
}

TEST_CASE("What is no recording is told apart by its first bytes") {
  const TemporaryFolder folder;
  std::ofstream(folder.path("slide.txt")) << "0 0 0\n";
  CHECK_FALSE(is_recording(folder.path("slide.txt")));
  CHECK_FALSE(is_recording(folder.path("missing")));
  CHECK_FALSE(is_recording(folder.path("")));
}

TEST_CASE("A recording that is not committed leaves no file") {
  const TemporaryFolder folder;
  {
    std::mt19937_64 random(1);
    auto writer = RecordingWriter::create(folder.path("a.spmrec"), header_of_two());
    REQUIRE(writer);
    for (std::size_t i = 0; i < 3000; ++i) writer->append(row_of(i, random));
  }
  CHECK(std::filesystem::is_empty(folder.path("")));
}

TEST_CASE("A recording of the first form is read as such, and one of a newer form refused") {
  const TemporaryFolder folder;
  const auto written = [&](std::uint32_t form) {
    RecordingHeader header = header_of_two();
    header.form = form;
    auto writer = RecordingWriter::create(folder.path("a.spmrec"), header);
    REQUIRE(writer);
    REQUIRE(writer->commit());
    return read_recording(folder.path("a.spmrec"));
  };
  const auto first = written(1);
  REQUIRE(first);
  CHECK(first->header.form == 1);
  // As written by programs that knew no other form.
  CHECK(content(folder.path("a.spmrec")).find("\"form\"") == std::string::npos);
  const auto now = written(recording_form);
  REQUIRE(now);
  CHECK(now->header.form == 2);
  const auto newer = written(recording_form + 1);
  REQUIRE_FALSE(newer);
  CHECK(newer.error().code == ExitCode::invalid_input);
  CHECK(newer.error().message.find("newer") != std::string::npos);
}

}  // namespace recording_test
