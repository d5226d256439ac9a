// SPDX-License-Identifier: Apache-2.0
#include <spdlog/sinks/ostream_sink.h>
#include <spdlog/spdlog.h>

#include <array>
#include <catch2/catch.hpp>
#include <cmath>
#include <fstream>
#include <memory>
#include <numbers>
#include <sstream>
#include <string>

#include "servo/devices/sim/device_sim.hpp"
#include "servo/force/sampled_tool.hpp"
#include "tests/servo/support/shape_asset.hpp"

namespace sim_tool_test {

using namespace spm;
using namespace spm::servo;

namespace {

/// A peg on a ball of 20 mm, held 12 mm above its tip.
struct PegOnBall {
  Asset ball = test::shape_asset(test::sphere(0.02, 2));
  Asset peg = test::shape_asset(test::box({6e-3, 24e-3, 6e-3}));
  AssetTables ball_tables = tables_of(ball), peg_tables = tables_of(peg);
  std::array<const AssetView*, 2> assets{&ball_tables.view(), &peg_tables.view()};
  ForceScene scene = scene_of({});

  PegOnBall() {
    scene.objects[0].force.method = Method::proxy;
    scene.tool = ToolSettings{};
    scene.tool->asset = 1;
    scene.tool->samples = 1500;
  }
  [[nodiscard]] DeviceSetup setup() const { return {1000, RealtimeMode::off, scene, assets}; }
};

/// What a device and the loop's force law did to one another, without the safety stage.
struct Held {
  std::size_t touching = 0;
  double torque = 0, farthest_turn = 0;  ///< N m and rad, the largest
};

Held hold(const PegOnBall& held, DeviceSim& device, std::size_t ticks) {
  auto tool = SampledTool::make(*held.assets[1], *held.scene.tool, 1, 1);
  REQUIRE(tool);
  SceneForce force(held.scene, 1e-3, device.capabilities().encoder_step, 0, {},
                   hand_turning(device.capabilities()));
  force.take_tool(tool->get(), 0);
  Held found;
  for (std::size_t i = 0; i < ticks; ++i) {
    DeviceState state;
    REQUIRE(device.read(state) == DeviceHealth::ok);
    REQUIRE(std::abs(state.orientation.norm() - 1) < 1e-9);
    const ContactForce contact =
        force.next(held.assets, HandPose{state.position, state.orientation});
    found.touching += contact.contact ? 1 : 0;
    found.torque = std::max(found.torque, contact.torque.norm());
    found.farthest_turn =
        std::max(found.farthest_turn,
                 turn_between(Eigen::Quaterniond::Identity(), state.orientation).norm());
    REQUIRE(device.write({contact.force, contact.torque}) == DeviceHealth::ok);
  }
  return found;
}

}  // namespace

TEST_CASE(
    "A hand that holds a tool touches at least 60 % of the ticks, turns it and feels torque") {
  const PegOnBall held;
  for (const char* text : {"", "hand=push", "profile=touch", "profile=falcon,seed=3"}) {
    INFO(text);
    DeviceSim device(*parse_sim_options(text));
    REQUIRE(device.open(held.setup()));
    CHECK(device.capabilities().turns);
    CHECK(device.capabilities().torque_cap > 0);
    const Held found = hold(held, device, 4000);
    CHECK(found.touching >= 2400);
    CHECK(found.torque > 1e-3);
    CHECK(found.farthest_turn > 0.1);
  }
}

/// Boxes of 30 mm as `full` assets, one on another by the paper's equations.
struct PaperBoxes {
  Asset box = test::box_asset(0.03);
  AssetTables tables = tables_of(box);
  std::array<const AssetView*, 2> assets{&tables.view(), &tables.view()};
  ForceScene scene = scene_of({});

  explicit PaperBoxes(double stiffness) {
    scene.objects[0].force.method = Method::paper;
    scene.objects[0].force.stiffness = stiffness;
    scene.tool = ToolSettings{};
    scene.tool->asset = 1;
  }
};

/// What is logged while a device is opened.
std::string told_by(DeviceSim& device, const PaperBoxes& boxes) {
  std::ostringstream told;
  const auto before = spdlog::default_logger();
  spdlog::set_default_logger(std::make_shared<spdlog::logger>(
      "test", std::make_shared<spdlog::sinks::ostream_sink_mt>(told)));
  const auto opened = device.open({1000, RealtimeMode::off, boxes.scene, boxes.assets});
  spdlog::set_default_logger(before);
  REQUIRE(opened);
  return told.str();
}

TEST_CASE("A hand that finds no way on which its tool touches says so, and else does not") {
  DeviceSim device(*parse_sim_options(""));
  CHECK(told_by(device, PaperBoxes(1000)).empty());
  const std::string told = told_by(device, PaperBoxes(0));
  CHECK(told.find("no way was found") != std::string::npos);
  CHECK(told.find("sim:hand=path") != std::string::npos);
}

TEST_CASE(
    "Without torque the device turns and gives none, without turns it keeps its orientation") {
  const PegOnBall held;
  DeviceSim pushing(*parse_sim_options("torque=off"));
  REQUIRE(pushing.open(held.setup()));
  CHECK(pushing.capabilities().turns);
  CHECK(pushing.capabilities().torque_cap == 0);
  Held found = hold(held, pushing, 3000);
  CHECK(found.touching >= 1800);
  CHECK(found.torque == 0);
  CHECK(found.farthest_turn > 0.1);
  DeviceSim fixed(*parse_sim_options("turns=off"));
  REQUIRE(fixed.open(held.setup()));
  CHECK_FALSE(fixed.capabilities().turns);
  found = hold(held, fixed, 3000);
  CHECK(found.touching >= 1800);
  CHECK(found.torque == 0);
  CHECK(found.farthest_turn == 0);
}

TEST_CASE("The same options and seed move a held tool the same again") {
  const PegOnBall held;
  std::array<Vector3, 2> last;
  for (Vector3& position : last) {
    DeviceSim device(*parse_sim_options("seed=5"));
    REQUIRE(device.open(held.setup()));
    static_cast<void>(hold(held, device, 1000));
    DeviceState state;
    REQUIRE(device.read(state) == DeviceHealth::ok);
    position = state.position;
  }
  CHECK(last[0] == last[1]);
}

TEST_CASE("A path of seven columns leads place and turn of the tool") {
  const test::TemporaryFolder folder;
  const std::string path = folder.file("path.txt");
  {
    std::ofstream file(path);
    for (int i = 0; i < 1000; ++i) {
      const double half = i * 0.25e-3;
      file << 0.1 + i * 1e-5 << " 0 0.05 " << std::cos(half) << " 0 " << std::sin(half) << " 0\n";
    }
  }
  const PegOnBall held;
  DeviceSim device(*parse_sim_options("path=" + path));
  REQUIRE(device.open(held.setup()));
  const Held found = hold(held, device, 2500);
  CHECK(found.touching == 0);
  CHECK(found.farthest_turn == Approx(0.5).margin(0.02));
  DeviceState state;
  REQUIRE(device.read(state) == DeviceHealth::ok);
  CHECK((state.position - Vector3(0.10999, 0, 0.05)).norm() < 3e-4);
}

TEST_CASE("Without a tool the simulated device turns where it is told to, and only then") {
  PegOnBall held;
  held.scene.tool.reset();
  DeviceSim plain(*parse_sim_options(""));
  REQUIRE(plain.open(held.setup()));
  CHECK_FALSE(plain.capabilities().turns);
  CHECK(hand_turning(plain.capabilities()).torque_cap == 0);
  DeviceSim turning(*parse_sim_options("turns=on"));
  REQUIRE(turning.open(held.setup()));
  CHECK(turning.capabilities().turns);
  CHECK(turning.capabilities().torque_cap == Approx(12 * 0.05));
  CHECK(turning.capabilities().turn_step == Approx(20e-6 / 0.1));
  DeviceState state;
  REQUIRE(turning.read(state) == DeviceHealth::ok);
  REQUIRE(turning.write({Vector3::Zero(), Vector3(0, 0, 0.05)}) == DeviceHealth::ok);
  for (int i = 0; i < 20; ++i) {
    REQUIRE(turning.write({Vector3::Zero(), Vector3(0, 0, 0.05)}) == DeviceHealth::ok);
  }
  REQUIRE(turning.read(state) == DeviceHealth::ok);
  CHECK(turn_between(Eigen::Quaterniond::Identity(), state.orientation).z() > 0.005);
}

TEST_CASE("An asset that can be no tool is told before the loop starts") {
  PegOnBall held;
  held.scene.tool->placement.scale = 0;
  DeviceSim device(*parse_sim_options(""));
  const auto opened = device.open(held.setup());
  REQUIRE_FALSE(opened);
  CHECK(opened.error().code == ExitCode::invalid_input);
}

}  // namespace sim_tool_test
