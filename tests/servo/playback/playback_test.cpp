// SPDX-License-Identifier: Apache-2.0
#include "servo/playback/playback.hpp"

#include <catch2/catch.hpp>
#include <cstring>
#include <filesystem>
#include <map>

#include "servo/playback/playback_columns.hpp"
#include "servo/playback/playback_marks.hpp"
#include "tests/servo/support/shape_asset.hpp"

namespace playback_test {

using namespace spm;
using namespace spm::servo;
using spm::test::TemporaryFolder;

namespace {

constexpr std::size_t ticks = 1000;

RecordedScene scene() {
  RecordedScene recorded;
  recorded.scene.workspace.position = {1, 0, 0};
  recorded.scene.workspace.scale = 2;
  recorded.scene.objects.resize(1);
  recorded.gone = {false};
  return recorded;
}

RecordingHeader header() {
  RecordingHeader header;
  header.spm_version = "1";
  header.devices.resize(1);
  header.devices[0].name = "sim";
  header.causes = {"none", "stalled", "of another version"};
  header.assets = {{"/nowhere/<b>.spm.exr", "1"}};
  header.scene = text_of(scene());
  return header;
}

/// The hand goes along x, 1 mm a tick, and is pushed along x by 2 N.
RecordingRow row(std::size_t i) {
  RecordingRow row;
  row.tick = 500 + i;
  row.position = {1e-3 * double(i), 0, 0};
  row.sent = {2, 0, 0};
  row.wanted = {3, 0, 0};
  row.depth = 1e-4;
  row.wake_ns = 50'000;
  row.busy_ns = 20'000;
  return row;
}

Recording recording() {
  Recording made;
  made.header = header();
  for (std::size_t i = 0; i < ticks; ++i) made.rows.push_back(row(i));
  return made;
}

std::string write(const TemporaryFolder& folder, const Recording& made) {
  std::string path = folder.path() + "/run.spmrec";
  auto writer = RecordingWriter::create(path, made.header);
  REQUIRE(writer);
  for (const RecordingRow& one : made.rows) writer->append(one);
  REQUIRE(writer->commit());
  return path;
}

/// What columns_of() wrote, by the columns' names.
struct Columns {
  std::vector<double> tick;
  std::map<std::string, std::vector<float>> by_name;
};
Columns read(const std::string& bytes) {
  std::uint32_t head[2] = {0, 0};
  std::memcpy(head, bytes.data(), sizeof head);
  const std::size_t rows = head[0], wide = head[1];
  Columns columns;
  columns.tick.resize(rows);
  std::memcpy(columns.tick.data(), bytes.data() + 8, 8 * rows);
  const auto names = column_names();
  REQUIRE(wide == names.size());
  REQUIRE(bytes.size() == 8 + 8 * rows + 4 * rows * wide);
  for (std::size_t i = 0; i < names.size(); ++i) {
    std::vector<float>& column = columns.by_name[names[i]];
    column.resize(rows);
    std::memcpy(column.data(), bytes.data() + 8 + 8 * rows + 4 * rows * i, 4 * rows);
  }
  return columns;
}

}  // namespace

TEST_CASE("A recording is told in the world's frame, and the work is that of its forces") {
  Columns columns = read(columns_of(recording(), 0, scene().scene.workspace, 0));
  REQUIRE(columns.tick.size() == ticks);
  CHECK(columns.tick.front() == 500);
  CHECK(columns.by_name["x"][10] == Approx(1 + 2 * 10e-3));
  CHECK(columns.by_name["fx"][10] == 2);
  CHECK(columns.by_name["wx"][10] == 3);
  CHECK(columns.by_name["wake"][10] == Approx(50));
  // Newtons by the hand's own metres.
  CHECK(columns.by_name["work"][ticks - 1] == Approx(2 * 1e-3 * (ticks - 1)));
}

TEST_CASE("Of too many ticks each group is shown by the one with the largest force") {
  Recording made = recording();
  made.rows[437].sent = {0, 0, -9};
  Columns columns = read(columns_of(made, 0, scene().scene.workspace, 100));
  REQUIRE(columns.tick.size() == 100);
  CHECK(columns.tick[43] == 500 + 437);
  CHECK(columns.by_name["fz"][43] == -9);
  CHECK(columns.tick[44] == 500 + 440);
}

TEST_CASE("Faults, late ticks and caps are marked as stretches") {
  Recording made = recording();
  for (std::size_t i = 100; i < 150; ++i) made.rows[i].cause = 1;
  for (std::size_t i = 150; i < 160; ++i) made.rows[i].cause = 2;
  made.rows[300].busy_ns = 1'200'000;
  made.rows[310].busy_ns = 1'200'000;  // soon after it: one stretch
  made.rows[700].busy_ns = 1'200'000;
  made.rows[900].flags = recorded_force_capped;
  const Marks marks = marks_of(made, 0);
  REQUIRE(marks.list.size() == 5);
  CHECK(marks.list[0].kind == MarkKind::off);
  CHECK(marks.list[0].first == 600);
  CHECK(marks.list[0].last == 649);
  CHECK(marks.list[1].cause == 2);
  CHECK(marks.list[2].kind == MarkKind::late);
  CHECK(marks.list[2].last == 810);
  CHECK(marks.list[3].first == 1200);
  CHECK(marks.list[4].kind == MarkKind::capped);
  CHECK(marks_of(made, 0, 1).list.size() == 3);
  CHECK(marks_of(made, 0, 1).found[0] == 2);
}

TEST_CASE("A recording whose asset is gone is played without its surface, and says so") {
  const TemporaryFolder folder;
  Recording made = recording();
  made.rows[7].cause = 1;
  const auto playback = Playback::open(write(folder, made));
  REQUIRE(playback);
  const auto told = playback->summary();
  CHECK(told["name"] == "run.spmrec");
  CHECK(told["loss"].get<std::string>().empty());
  CHECK(told["assets"][0]["name"] == "<b>.spm.exr");
  CHECK(told["assets"][0]["drawn"] == false);
  CHECK_THAT(told["assets"][0]["problem"].get<std::string>(), Catch::Contains("/nowhere/"));
  CHECK(told["devices"][0]["rows"] == ticks);
  CHECK(told["devices"][0]["tool"].is_null());
  CHECK(told["devices"][0]["marks"]["list"][0]["first"] == 507);
  CHECK_FALSE(told["causes"][1]["cure"].get<std::string>().empty());
  CHECK(told["causes"][2]["cure"].get<std::string>().empty());
  CHECK(read(playback->rows(0)).tick.size() == ticks);
}

TEST_CASE("A recording without a tick is refused with a cure") {
  const TemporaryFolder folder;
  Recording made = recording();
  made.rows.clear();
  const auto playback = Playback::open(write(folder, made));
  REQUIRE_FALSE(playback);
  CHECK(playback.error().code == ExitCode::invalid_input);
  CHECK_THAT(playback.error().message, Catch::Contains("no tick to show; record"));
}

TEST_CASE("An object that moves all the time is told of 60 times a second, where it was last") {
  std::vector<SceneStep> steps;
  for (std::uint64_t tick = 0; tick < ticks; ++tick) {
    SceneStep step;
    step.tick = tick;
    step.settings.placement.position = {double(tick), 0, 0};
    steps.push_back(step);
  }
  SceneStep removed;
  removed.tick = ticks;
  removed.kind = RecordedKind::removed;
  steps.push_back(removed);
  const std::string bytes = steps_bytes(scene(), steps, 1000);
  std::vector<double> numbers(bytes.size() / sizeof(double));
  std::memcpy(numbers.data(), bytes.data(), bytes.size());
  const std::size_t told = numbers.size() / Playback::step_numbers;
  CHECK(told > 60);
  CHECK(told < 66);
  const double* const last = numbers.data() + (told - 2) * Playback::step_numbers;
  CHECK(last[0] == ticks - 1);
  CHECK(last[3] == ticks - 1);
  CHECK(last[10] == 1);
  CHECK(last[Playback::step_numbers + 1] == double(RecordedKind::removed));
}

}  // namespace playback_test
