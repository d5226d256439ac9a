// SPDX-License-Identifier: Apache-2.0
#include "formats/motion/recording.hpp"

#include <xxhash.h>

#include <algorithm>
#include <array>
#include <catch2/catch.hpp>
#include <cmath>
#include <cstring>
#include <filesystem>
#include <fstream>
#include <random>
#include <sstream>

#include "formats/motion/recording_salvage.hpp"
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
  header.devices.resize(2);
  header.devices[0] = {"falcon", 6.4e-5, 3000, 8, "falcon", true, 0.3, 1e-3, 2e-4};
  header.devices[1].name = "sim";
  header.devices[1].encoder_step = 2e-5;
  header.devices[1].turning_inertia = 3e-4;  // of a device that tells no turns, too
  header.causes = {"none", "starting"};
  header.assets = {{"/a/teeth.spm.exr", "abc"}, {"/a/b \xFF.spm.exr", "def"}};
  header.scene = R"({"objects":[]})";
  header.scene_path = "scene.toml";
  return header;
}

RecordingRow row_of(std::uint64_t tick, std::mt19937_64& random) {
  std::uniform_real_distribution<double> number(-1, 1);
  RecordingRow row;
  row.tick = tick;
  for (auto* vector : {&row.position, &row.wanted, &row.wanted_torque, &row.added,
                       &row.added_torque, &row.sent, &row.sent_torque, &row.tool_position}) {
    for (double& value : *vector) value = number(random);
  }
  for (auto* quaternion : {&row.orientation, &row.tool_orientation}) {
    for (double& value : *quaternion) value = number(random);
  }
  row.level = static_cast<std::uint32_t>(tick % 5);
  row.patches = static_cast<std::uint16_t>(tick % 17);
  row.depth = number(random);
  row.device = static_cast<std::uint16_t>(tick % 2);
  row.cause = static_cast<std::uint16_t>(tick % 3 == 0);
  row.flags = recorded_contact | recorded_torque_capped | recorded_tool;
  return row;
}

/// Changes of every kind, one after the other.
RecordedChange change_of(std::uint64_t tick) {
  RecordedChange change;
  change.tick = tick;
  change.kind = static_cast<RecordedKind>(2 + tick % 7);
  change.object = change.kind <= RecordedKind::removed ? static_cast<std::uint32_t>(tick) : 0;
  if (change.kind == RecordedKind::placed) change.pose = {0.1, -0.2, 1e-9, 0.6, 0, -0.8, 0};
  const bool set = change.kind == RecordedKind::added || change.kind == RecordedKind::changed ||
                   change.kind == RecordedKind::stabilized;
  if (set) change.settings = R"({"stiffness":1})";
  if (change.kind == RecordedKind::assets) change.assets = {{"/a", "1"}, {"/b", "2"}};
  return change;
}

std::string recording_of(const TemporaryFolder& folder, std::size_t rows) {
  std::mt19937_64 random(5);
  auto writer = RecordingWriter::create(folder.path("a.spmrec"), header_of_two());
  REQUIRE(writer);
  for (std::size_t i = 0; i < rows; ++i) {
    if (i % 3 == 1) writer->append(change_of(i));
    writer->append(row_of(i, random));
  }
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
    CHECK(recording->header.devices[0].force_cap == 8);
    CHECK(recording->header.devices[0].profile == "falcon");
    CHECK(recording->header.devices[0].turns);
    CHECK(recording->header.devices[0].torque_cap == 0.3);
    CHECK(recording->header.devices[0].turn_step == 1e-3);
    CHECK(recording->header.devices[0].turning_inertia == 2e-4);
    CHECK_FALSE(recording->header.devices[1].turns);
    CHECK(recording->header.devices[1].turning_inertia == 3e-4);
    CHECK(recording->header.devices[1].torque_cap == 0);
    CHECK(recording->header.assets[0] == header_of_two().assets[0]);
    CHECK(recording->header.scene == header_of_two().scene);
    CHECK(recording->header.scene_path == "scene.toml");
    REQUIRE(recording->rows.size() == rows);
    std::mt19937_64 random(5);
    for (std::size_t i = 0; i < rows; ++i) {
      const RecordingRow wanted = row_of(i, random);
      REQUIRE(recording->rows[i] == wanted);
    }
    REQUIRE(recording->changes.size() == (rows + 1) / 3);
    for (const RecordedChange& change : recording->changes) {
      const RecordedChange wanted = change_of(change.tick);
      REQUIRE(change.kind == wanted.kind);
      REQUIRE(change.object == wanted.object);
      REQUIRE(change.pose == wanted.pose);
      REQUIRE(change.settings == wanted.settings);
      REQUIRE(change.assets == wanted.assets);
    }
  }
}

TEST_CASE(
    "Of a recording that was cut anywhere in its parts the whole ones are salvaged and told") {
  const TemporaryFolder folder;
  const std::string path = recording_of(folder, 20);
  const std::string whole = content(path);
  const auto intact = salvage_recording(path);
  REQUIRE(intact);
  CHECK(intact->loss.empty());
  REQUIRE(intact->recording.rows.size() == 20);
  const std::size_t header = recording_start(header_of_two()).size();
  const std::string cut = folder.path("cut.spmrec");
  std::size_t most = 0;
  for (std::size_t size = whole.size() - 1; size > header + sizeof(RecordingRow) + 8; size -= 97) {
    std::ofstream(cut, std::ios::binary) << whole.substr(0, size);
    const auto read = salvage_recording(cut);
    REQUIRE(read);
    const std::size_t rows = read->recording.rows.size();
    most = std::max(most, rows);
    CHECK(rows <= (size - header) / (sizeof(RecordingRow) + 8));
    CHECK_THAT(read->loss, Catch::Contains("cut.spmrec: was cut short") &&
                               Catch::Contains("first " + std::to_string(rows) + " rows"));
    for (std::size_t i = 0; i < rows; ++i) {
      REQUIRE(read->recording.rows[i] == intact->recording.rows[i]);
    }
  }
  CHECK(most == 20);
  std::ofstream(cut, std::ios::binary) << whole.substr(0, header + 40);
  const auto empty = salvage_recording(cut);
  REQUIRE_FALSE(empty);
  CHECK_THAT(empty.error().message, Catch::Contains("before its first tick"));
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

TEST_CASE("A recording whose header or change nests too deep is refused, its checksum right") {
  const TemporaryFolder folder;
  const std::string path = folder.path("deep.spmrec");
  const auto number = [](auto value) {
    return std::string(reinterpret_cast<const char*>(&value), sizeof value);
  };
  const auto refused = [&](std::string bytes, std::uint64_t parts, const char* cause) {
    bytes += number(parts);
    bytes += number(std::uint64_t{XXH3_64bits(bytes.data(), bytes.size())});
    std::ofstream(path, std::ios::binary) << bytes;
    for (const auto& read :
         {read_recording(path).map([](auto&&) {}), salvage_recording(path).map([](auto&&) {})}) {
      REQUIRE_FALSE(read);
      CHECK(read.error().code == ExitCode::invalid_input);
      CHECK_THAT(read.error().message, Catch::Contains(cause));
    }
  };
  std::string deep = R"({"form":)" + std::string(200'003, '[') + std::string(200'003, ']') + "}";
  deep.append((8 - deep.size() % 8) % 8, ' ');
  const auto size = static_cast<std::uint32_t>(deep.size());
  const std::string start = recording_start(header_of_two());
  refused(start.substr(0, 8) + number(size) + number(std::uint32_t{0}) + deep, 0,
          "has a header that is no JSON object");
  refused(start + number(static_cast<std::uint32_t>(RecordedKind::assets)) + number(size) + deep, 1,
          "a change is no JSON object");
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

TEST_CASE("A recording of an older or newer form is refused with what to do") {
  const TemporaryFolder folder;
  const auto written = [&](std::uint32_t form) {
    RecordingHeader header = header_of_two();
    header.form = form;
    auto writer = RecordingWriter::create(folder.path("a.spmrec"), header);
    REQUIRE(writer);
    REQUIRE(writer->commit());
    return read_recording(folder.path("a.spmrec"));
  };
  REQUIRE(written(recording_form));
  for (const std::uint32_t form : {1U, 2U, 3U, 4U, recording_form + 1}) {
    const auto refused = written(form);
    REQUIRE_FALSE(refused);
    CHECK(refused.error().code == ExitCode::invalid_input);
    const std::string& message = refused.error().message;
    CHECK(message.find(form > recording_form ? "newer" : "older") != std::string::npos);
    CHECK(message.find("replay it with that version") != std::string::npos);
    if (form < recording_form) CHECK(message.find("spm-servo 1.2.3") != std::string::npos);
  }
}

TEST_CASE("Parts that are wrong within a file whose checksum is right are refused with a cause") {
  const TemporaryFolder folder;
  const std::string path = folder.path("a.spmrec");
  const auto refused = [&](const std::string& part) {
    REQUIRE(write_recording(path, recording_start(header_of_two()),
                            std::array{std::string_view(part)}));
    const auto recording = read_recording(path);
    // A part that is cut short is not written at all.
    if (recording) return recording->rows.empty() && recording->changes.empty();
    return recording.error().code == ExitCode::invalid_input &&
           recording.error().message.starts_with(path + ": ");
  };
  std::mt19937_64 random(3);
  for (std::uint64_t tick = 0; tick < 8; ++tick) {
    std::string good;
    if (tick == 7) {
      append_part(good, row_of(tick, random));
    } else {
      append_part(good, change_of(tick));
    }
    for (std::size_t size = 0; size < good.size(); ++size) CHECK(refused(good.substr(0, size)));
    // Any bits of any byte: refused, or read without harm.
    for (std::size_t at = 0; at < good.size(); ++at) {
      std::string changed = good;
      changed[at] = static_cast<char>(random());
      static_cast<void>(refused(changed));
    }
  }
  RecordedChange wrong = change_of(0);
  for (const double bad : {0.0, 2.0, std::numeric_limits<double>::quiet_NaN(),
                           std::numeric_limits<double>::infinity()}) {
    for (const std::size_t at : {0U, 3U}) {
      wrong = change_of(0);
      if (at == 0 && std::isfinite(bad)) continue;
      wrong.pose[at] = bad;
      std::string part;
      append_part(part, wrong);
      CHECK(refused(part));
    }
  }
  wrong = change_of(0);
  wrong.object = 1U << 20U;
  std::string part;
  append_part(part, wrong);
  CHECK(refused(part));
}

}  // namespace recording_test
