// SPDX-License-Identifier: Apache-2.0
#include "servo/record/recorded_scene.hpp"

#include <catch2/catch.hpp>
#include <cstring>
#include <limits>
#include <nlohmann/json.hpp>
#include <random>

#include "servo/record/run_recorder.hpp"
#include "tests/servo/support/shape_asset.hpp"

namespace recorded_scene_test {

using namespace spm;
using namespace spm::servo;
using spm::test::TemporaryFolder;

namespace {

/// An object with another value in every field.
PlacedObject object_of(double at) {
  PlacedObject object;
  object.asset = 1;
  object.placement.position = {at, 1.0 / 3, -1e-9};
  object.placement.rotation = Eigen::Quaterniond(0.5, -0.5, 0.5, 0.5);
  object.placement.scale = 1.1;
  object.force = {Method::proxy, PaperRule::all_planes, 123.4,
                  1e-3,          ProbeKind::capsule,    PaperProbeForm::volume,
                  7e-3,          {0.6, 0, -0.8},        2.5};
  EffectSettings& effects = object.effects;
  effects.friction = {0.31, 0.21, 777.7};
  effects.damping = 0.7;
  effects.texture = {1e-5, 2e-3, 0xFFFFFFFFFFFFFFFFU};
  effects.smoothing = {3e-4, 9};
  effects.turn = {120.5, 0.61, 2e-3};
  effects.friction_force = 0.11;
  effects.friction_depth = 12.5;
  effects.texture_noise = 3e-6;
  effects.noise_seed = 42;
  object.movable = true;
  return object;
}

RecordedScene scene() {
  RecordedScene recorded;
  recorded.scene.workspace.position = {0.1, 0.2, 0.3};
  recorded.scene.workspace.scale = 2;
  recorded.scene.objects = {object_of(0.1), object_of(0.2)};
  recorded.scene.stabilization = {
      0.9, 1.3, 1e-3, 2000.5, 3.5, true, 5e-5, VelocityMethod::difference, 0.25};
  recorded.gone = {false, true};
  return recorded;
}

RecordingHeader header_of_one() {
  RecordingHeader header;
  header.devices.resize(1);
  header.causes = {"none"};
  header.assets = {{"/a", "1"}, {"/b", "2"}};
  return header;
}

}  // namespace

TEST_CASE("A scene's tool comes back from its text bit by bit, and one that is none is refused") {
  RecordedScene wanted = scene();
  ToolSettings tool;
  tool.asset = 1;
  tool.placement.position = {0.01, 1.0 / 3, -2e-3};
  tool.placement.rotation = Eigen::Quaterniond(0.5, 0.5, -0.5, 0.5);
  tool.placement.scale = 0.3;
  tool.coupling = 700.1;
  tool.turning = 0.7;
  tool.spacing = 1e-4 / 3;
  tool.samples = 12345;
  tool.budget = 3e-4;
  wanted.scene.added.force.stiffness = 1234.5;
  for (const double cap : {0.0, 0.125, std::numeric_limits<double>::infinity()}) {
    tool.torque_cap = cap;
    wanted.scene.tool = tool;
    ToolSettings other = tool;
    other.placement.scale = 1.0 / 3;
    wanted.scene.more_tools = {other, tool};
    const std::string text = text_of(wanted);
    const auto read = recorded_scene(text, 2);
    REQUIRE(read);
    REQUIRE(read->scene.tool);
    CHECK(*read->scene.tool == tool);
    CHECK(read->scene.more_tools == wanted.scene.more_tools);
    CHECK(read->scene.added.force.stiffness == 1234.5);
    CHECK(text_of(*read) == text);
  }
  CHECK_FALSE(recorded_scene(text_of(wanted), 1));
  wanted.scene.tool->placement.rotation = Eigen::Quaterniond(0.5, 0.5, 0.5, 0.9);
  CHECK_FALSE(recorded_scene(text_of(wanted), 2));
  wanted.scene.tool.reset();
  wanted.scene.more_tools.clear();
  const auto without = recorded_scene(text_of(wanted), 2);
  REQUIRE(without);
  CHECK_FALSE(without->scene.tool);
}

TEST_CASE("A scene comes back from its text with every field, bit by bit") {
  const RecordedScene wanted = scene();
  const std::string text = text_of(wanted);
  const auto read = recorded_scene(text, 2);
  REQUIRE(read);
  CHECK(read->gone == wanted.gone);
  CHECK(read->scene.stabilization == wanted.scene.stabilization);
  CHECK(read->scene.workspace.position == wanted.scene.workspace.position);
  CHECK(read->scene.workspace.scale == 2);
  const PlacedObject& object = read->scene.objects[0];
  CHECK(object.placement.position == wanted.scene.objects[0].placement.position);
  CHECK(object.placement.rotation.coeffs() == wanted.scene.objects[0].placement.rotation.coeffs());
  CHECK(object.force.method == Method::proxy);
  CHECK(object.force.rule == PaperRule::all_planes);
  CHECK(object.force.form == PaperProbeForm::volume);
  CHECK(object.force.probe() == ProbeShape{ProbeKind::capsule, 1e-3, 7e-3});
  CHECK(object.force.probe_axis == Vector3(0.6, 0, -0.8));
  CHECK(object.effects.texture.seed == 0xFFFFFFFFFFFFFFFFU);
  CHECK(object.effects.smoothing.samples == 9);
  CHECK(object.movable);
  // The same text again: no field was lost on the way.
  CHECK(text_of(*read) == text);
}

TEST_CASE("A recording from before probes had a kind is of a point or a ball along z") {
  auto json = nlohmann::ordered_json::parse(text_of(scene()));
  for (auto& object : json["objects"]) {
    for (const char* key : {"probe_kind", "paper_probe", "probe_length_m", "probe_axis_x",
                            "probe_axis_y", "probe_axis_z"}) {
      REQUIRE(object.erase(key) == 1);
    }
  }
  const auto read = recorded_scene(json.dump(), 2);
  REQUIRE(read);
  const ForceSettings& force = read->scene.objects[0].force;
  CHECK(force.probe() == ProbeShape{ProbeKind::ball, 1e-3, 0});
  CHECK(force.form == PaperProbeForm::surface);
  CHECK(force.probe_axis == Vector3::UnitZ());
}

TEST_CASE("A probe whose axis is none is refused") {
  auto json = nlohmann::ordered_json::parse(text_of(scene()));
  json["objects"][0]["probe_axis_x"] = 0.5;
  CHECK_FALSE(recorded_scene(json.dump(), 2));
}

TEST_CASE("A text that is no scene is refused with a cause, or read without harm") {
  const std::string text = text_of(scene());
  CHECK_FALSE(recorded_scene(text, 1));  // an object names the second asset
  for (const char* bad : {"", "{}", "[]", "null", "{\"objects\":[]}"}) {
    const auto refused = recorded_scene(bad, 2);
    REQUIRE_FALSE(refused);
    CHECK(refused.error().code == ExitCode::invalid_input);
  }
  std::mt19937_64 random(7);
  for (int i = 0; i < 4000; ++i) {
    std::string changed = text;
    for (int bytes = 0; bytes < 3; ++bytes)
      changed[random() % changed.size()] = "0-9e\"{}[],:n"[random() % 12];
    const auto read = recorded_scene(changed, 2);
    if (!read) {
      CHECK(read.error().code == ExitCode::invalid_input);
      continue;
    }
    for (const PlacedObject& object : read->scene.objects) {
      CHECK(object.asset < 2);
      CHECK(object.placement.position.allFinite());
      CHECK(object.placement.scale > 0);
      CHECK(object.effects.smoothing.samples <= max_smoothing_samples);
    }
  }
}

TEST_CASE("Changes come back from their form in files, and a scene follows them") {
  RecordedScene followed = scene();
  StepRing ring = make_step_ring();
  ChangeTeller teller(ring, 4);
  SceneForce force(followed.scene, 1e-3, 0, 4);
  force.remove(1);
  force.tell(&teller);
  teller.begin(7);
  force.place(0, {1, 2, 3}, Eigen::Quaterniond(0, 1, 0, 0));
  force.place(0, {1, 2, 3}, Eigen::Quaterniond(0, 1, 0, 0));  // no change
  REQUIRE(force.add(object_of(0.5)) == std::size_t{1});
  REQUIRE(force.add(object_of(0.6)) == std::size_t{2});
  force.change(0, object_of(0.7));
  force.place(0, {1, 2, 3}, Eigen::Quaterniond(0, 1, 0, 0));
  force.remove(2);
  force.stabilize({});
  std::vector<RecordedKind> kinds;
  for (SceneStep step; ring.try_dequeue(step);) {
    kinds.push_back(step.kind);
    CHECK(step.tick == 7);
    followed.follow(step);
    const auto again = step_of(recorded(step), 2);
    REQUIRE(again);
    CHECK(again->object == step.object);
    CHECK(again->settings.placement.position == step.settings.placement.position);
    CHECK(again->settings.effects.noise_seed == step.settings.effects.noise_seed);
    CHECK(again->stabilization == step.stabilization);
  }
  using enum RecordedKind;
  CHECK(kinds == std::vector{placed, added, added, changed, placed, removed, stabilized});
  CHECK(followed.gone == std::vector{false, false, true});
  CHECK(followed.scene.objects[0].placement.position == Vector3(1, 2, 3));
  CHECK(followed.scene.objects[0].placement.scale == 1.1);
  CHECK_FALSE(followed.scene.stabilization.any());
}

TEST_CASE("Changes that did not fit into the ring are marked as lost") {
  StepRing ring(8);
  ChangeTeller teller(ring, 1);
  for (int i = 0; i < 1000; ++i) {
    teller.begin(static_cast<std::uint64_t>(i));
    teller.placed(0, {1.0 * i, 0, 0}, Eigen::Quaterniond::Identity());
  }
  SceneStep step;
  while (ring.try_dequeue(step)) CHECK(step.kind == RecordedKind::placed);
  teller.begin(1000);
  teller.placed(0, {-1, 0, 0}, Eigen::Quaterniond::Identity());
  REQUIRE(ring.try_dequeue(step));
  CHECK(step.kind == RecordedKind::lost);
  CHECK(step.tick == 1000);
  REQUIRE(ring.try_dequeue(step));
  CHECK(step.kind == RecordedKind::placed);
}

TEST_CASE("A recorder writes changes before their tick's rows, and a list of assets that changed") {
  const TemporaryFolder folder;
  StepRing ring = make_step_ring();
  RunRecorder::Settings settings;
  settings.header = header_of_one();
  settings.scene.objects = {object_of(0)};
  settings.record = folder.file("a.spmrec");
  std::vector<RecordedAsset> assets = settings.header.assets;
  settings.assets = [&] { return assets; };
  settings.warn = [](const std::string&) {};
  auto recorder = RunRecorder::create(std::move(settings), ring);
  REQUIRE(recorder);
  ChangeTeller teller(ring, 2);
  RecordingRow row;
  for (row.tick = 0; row.tick < 10; ++row.tick) {
    teller.begin(row.tick);
    if (row.tick % 3 == 0) {
      teller.placed(0, {1.0 * static_cast<double>(row.tick), 0, 0}, Eigen::Quaterniond::Identity());
    }
    row.flags = row.tick == 0 || row.tick == 5 || row.tick == 7 ? recorded_exchanged : 0;
    if (row.tick == 7) assets[1].content_sha256 = "3";
    recorder->take(row);
  }
  REQUIRE(recorder->finish());
  const auto read = read_recording(folder.file("a.spmrec"));
  REQUIRE(read);
  REQUIRE(read->changes.size() == 5);
  CHECK(read->changes[3].kind == RecordedKind::assets);
  CHECK(read->changes[3].tick == 7);
  CHECK(read->changes[4].tick == 9);
  CHECK(recorded_scene(read->header.scene, 2));
}

}  // namespace recorded_scene_test
