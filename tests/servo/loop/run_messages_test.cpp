// SPDX-License-Identifier: Apache-2.0
#include "servo/loop/run_messages.hpp"

#include <catch2/catch.hpp>
#include <limits>

#include "common/base/units.hpp"
#include "tests/servo/support/scripted_device.hpp"

namespace run_messages_test {

using namespace spm;
using namespace spm::servo;
using spm::test::ScriptedDevice;

namespace {

/// The warnings for one object of a stiffness, N/m, on a device of a profile.
std::vector<std::string> warnings_of(double stiffness, const char* profile, double cap) {
  ScriptedDevice device([](std::size_t, DeviceState&, DeviceHealth&) {});
  device.can().name = "hand";
  device.can().profile = find_device_profile(profile);
  device.can().stiffness_cap = cap;
  ForceChoice choice;
  choice.scene = scene_of({});
  choice.scene.objects.front().force.stiffness = stiffness;
  return stiffness_warnings(choice, {&device});
}

constexpr double uncapped = std::numeric_limits<double>::infinity();

}  // namespace

TEST_CASE("A stiffness that the device does not hold stably is warned of, with both numbers") {
  const auto warnings = warnings_of(100'000, "low", uncapped);
  REQUIRE(warnings.size() == 1);
  REQUIRE(warnings[0].find("100 N/mm") != std::string::npos);
  const double stable = auto_stiffness({find_device_profile("low"), uncapped});
  REQUIRE(warnings[0].find(format_quantity(stable, Quantity::stiffness)) != std::string::npos);
  REQUIRE(warnings[0].find("--stiffness auto") != std::string::npos);
}

TEST_CASE("What auto takes is not warned of, on any profile") {
  for (const DeviceProfile& profile : device_profiles) {
    CAPTURE(profile.name);
    const double stable = auto_stiffness({&profile, profile.stiffness_cap});
    REQUIRE(warnings_of(stable, profile.name.data(), profile.stiffness_cap).empty());
    REQUIRE(warnings_of(stable * 1.01, profile.name.data(), uncapped).size() == 1);
  }
}

TEST_CASE(
    "A device that holds its rated stiffness is warned of once, and one that does not twice") {
  REQUIRE(warnings_of(100'000, "touch", 400).size() == 1);
  REQUIRE(warnings_of(100'000, "falcon", 3000).size() == 2);
}

TEST_CASE("A rule or a form of method paper is warned of where no object is of method paper") {
  ForceChoice choice;
  choice.scene = scene_of({});
  ForceSettings& force = choice.scene.objects.front().force;
  for (const Method method : {Method::proxy, Method::spm}) {
    force = {};
    force.method = method;
    REQUIRE(paper_warnings(choice).empty());
    force.rule = PaperRule::all_planes;
    REQUIRE(paper_warnings(choice).size() == 1);
    REQUIRE(paper_warnings(choice)[0].find("--paper-rule") != std::string::npos);
    force.form = PaperProbeForm::volume;
    REQUIRE(paper_warnings(choice).size() == 2);
    REQUIRE(paper_warnings(choice)[1].find("--paper-probe") != std::string::npos);
  }
  choice.scene.objects.push_back(choice.scene.objects.front());
  choice.scene.objects.back().force.method = Method::paper;
  REQUIRE(paper_warnings(choice).empty());
}

TEST_CASE("A tool on a device that does not turn, or in too small a workspace, is warned of") {
  ScriptedDevice device([](std::size_t, DeviceState&, DeviceHealth&) {});
  device.can().name = "hand";
  device.can().turns = true;
  device.can().workspace = Vector3(0.05, 0.05, 0.03);
  ForceChoice choice;
  choice.scene = scene_of({});
  choice.tool_place = "scene.toml: line 3: ";
  std::vector<KeeperReport> assets(1);
  assets[0].metadata.box_min = Vector3(-0.01, -0.01, 0);
  assets[0].metadata.box_max = Vector3(0.01, 0.01, 0.04);
  REQUIRE(tool_warnings(choice, assets, {&device}).empty());
  choice.scene.tool = ToolSettings{};
  REQUIRE(tool_warnings(choice, assets, {&device}).empty());
  choice.scene.tool->placement.scale = 3;
  auto warnings = tool_warnings(choice, assets, {&device});
  REQUIRE(warnings.size() == 1);
  CHECK(warnings[0].find("scene.toml: line 3: the tool is 120 mm long") == 0);
  CHECK(warnings[0].find("hand 100 mm") != std::string::npos);
  choice.scene.workspace.scale = 2;
  REQUIRE(tool_warnings(choice, assets, {&device}).empty());
  device.can().turns = false;
  warnings = tool_warnings(choice, assets, {&device});
  REQUIRE(warnings.size() == 1);
  CHECK(warnings[0].find("keeps the orientation") != std::string::npos);
}

TEST_CASE(
    "A coupling stiffer than the device bears is told with what is asked, what is used, and why") {
  ScriptedDevice device([](std::size_t, DeviceState&, DeviceHealth&) {});
  device.can().name = "hand";
  device.can().turns = true;
  device.can().stiffness_cap = 1500;
  device.can().torque_cap = 0.2;
  ForceChoice choice;
  choice.scene = scene_of({});
  choice.tool_place = "scene.toml: line 3: ";
  const std::vector<KeeperReport> assets(1);
  choice.scene.tool = ToolSettings{};
  choice.scene.tool->coupling = 1500;
  REQUIRE(tool_warnings(choice, assets, {&device}).empty());
  choice.scene.tool->coupling = 20'000;
  choice.scene.tool->turning = 100;
  const auto warnings = tool_warnings(choice, assets, {&device});
  REQUIRE(warnings.size() == 2);
  CHECK(warnings[0].find("scene.toml: line 3: 'coupling' of [tool] asks for 20 N/mm") == 0);
  CHECK(warnings[0].find("the 1.5 N/mm that hand renders stably") != std::string::npos);
  CHECK(warnings[1].find("'turning' of [tool] asks for 100 ") != std::string::npos);
  CHECK(warnings[1].find("torque cap") != std::string::npos);
}

TEST_CASE("A coupling that a device is given but does not hold stably is told") {
  // Of no stiffness limit, as the simulated one.
  ScriptedDevice device([](std::size_t, DeviceState&, DeviceHealth&) {});
  device.can().name = "sim";
  device.can().turns = true;
  device.can().profile = find_device_profile("touch");
  ForceChoice choice;
  choice.scene = scene_of({});
  choice.tool_place = "scene.toml: line 3: ";
  const std::vector<KeeperReport> assets(1);
  choice.scene.tool = ToolSettings{};
  choice.scene.tool->coupling = 3600;
  REQUIRE(tool_warnings(choice, assets, {&device}).empty());
  choice.scene.tool->coupling = 50'000;
  const auto warnings = tool_warnings(choice, assets, {&device});
  REQUIRE(warnings.size() == 1);
  CHECK(warnings[0].find("scene.toml: line 3: 'coupling' of [tool] is 50 N/mm, more than") == 0);
  CHECK(warnings[0].find("3.62 N/mm that sim holds stably by simulation") != std::string::npos);
  device.can().stiffness_cap = 3000;
  REQUIRE(tool_warnings(choice, assets, {&device}).size() == 1);
  CHECK(tool_warnings(choice, assets, {&device})[0].find("is held to that") != std::string::npos);
}

TEST_CASE("Torque that a device or a scene leaves out is told once, with what the hand gets") {
  ScriptedDevice device([](std::size_t, DeviceState&, DeviceHealth&) {});
  device.can().name = "hand";
  device.can().turns = true;
  device.can().force_cap = 5;
  device.can().torque_cap = 0;
  ForceChoice choice;
  choice.scene = scene_of({});
  choice.tool_place = "scene.toml: line 3: ";
  CHECK(tool_notes(choice, {&device}).empty());
  choice.scene.tool = ToolSettings{};
  auto notes = tool_notes(choice, {&device});
  REQUIRE(notes.size() == 1);
  CHECK(notes[0].find("hand gives no torque: the torque is left out") == 0);
  CHECK(notes[0].find("the hand gets the force alone") != std::string::npos);
  device.can().torque_cap = 0.2;
  CHECK(tool_notes(choice, {&device}).empty());
  choice.scene.tool->torque_cap = 0;
  notes = tool_notes(choice, {&device});
  REQUIRE(notes.size() == 1);
  CHECK(notes[0].find("scene.toml: line 3: 'torque_cap' of [tool] is 0: the torque") == 0);
  device.can().force_cap = device.can().torque_cap = 0;
  notes = tool_notes(choice, {&device});
  REQUIRE(notes.size() == 1);
  CHECK(notes[0].find("neither force nor torque") != std::string::npos);
  // That it does not turn is warned of.
  device.can().turns = false;
  CHECK(tool_notes(choice, {&device}).empty());
}

TEST_CASE("What a tool feels objects without is warned of") {
  ScriptedDevice device([](std::size_t, DeviceState&, DeviceHealth&) {});
  device.can().turns = true;
  ForceChoice choice;
  choice.scene = scene_of({});
  choice.scene.tool = ToolSettings{};
  choice.unfelt = {"scene.toml: line 5: 'smoothing' is left out"};
  CHECK(tool_warnings(choice, std::vector<KeeperReport>(1), {&device}) == choice.unfelt);
}

TEST_CASE("A workspace's scale at which nothing can be felt is warned of, with its key") {
  ScriptedDevice device([](std::size_t, DeviceState&, DeviceHealth&) {});
  device.can().name = "hand";
  device.can().workspace = Vector3(0.05, 0.05, 0.03);
  ForceChoice choice;
  choice.scene = scene_of({});
  choice.scene_path = "scene.toml";
  std::vector<KeeperReport> assets(1);
  assets[0].metadata.box_max = Vector3(0.01, 0.01, 0.04);
  assets[0].metadata.tolerance = 5e-5;
  for (const double scale : {0.01, 1.0, 100.0}) {
    choice.scene.workspace.scale = scale;
    CHECK(workspace_warnings(choice, assets, {&device}).empty());
  }
  choice.scene.workspace.scale = 1e6;
  auto warnings = workspace_warnings(choice, assets, {&device});
  REQUIRE(warnings.size() == 1);
  CHECK(warnings[0].find("scene.toml: 'scale' of [workspace] is 1e+06") == 0);
  CHECK(warnings[0].find("lower it") != std::string::npos);
  choice.scene.workspace.scale = 1e-6;
  warnings = workspace_warnings(choice, assets, {&device});
  REQUIRE(warnings.size() == 1);
  CHECK(warnings[0].find("raise it") != std::string::npos);
}

TEST_CASE("An object that may pass between the samples of a tool is warned of, and no other") {
  ForceChoice choice;
  choice.scene = scene_of({});
  choice.places = {"scene.toml: line 5: "};
  std::vector<KeeperReport> assets(2);
  assets[0].metadata.box_min = Vector3(-0.01, -0.01, 0);
  assets[0].metadata.box_max = Vector3(0.01, 0.01, 0.004);
  assets[1].tools = {{100, 0.007}};
  REQUIRE(tool_warnings(choice, assets, {}).empty());
  choice.scene.tool = ToolSettings{};
  choice.scene.tool->asset = 1;
  const auto warnings = tool_warnings(choice, assets, {});
  REQUIRE(warnings.size() == 1);
  CHECK(warnings[0].find("scene.toml: line 5: the object is 4 mm wide") == 0);
  CHECK(warnings[0].find("7 mm apart") != std::string::npos);
  choice.scene.objects[0].placement.scale = 2;
  CHECK(tool_warnings(choice, assets, {}).empty());
}

}  // namespace run_messages_test
