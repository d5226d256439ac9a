// SPDX-License-Identifier: Apache-2.0
#include <array>
#include <catch2/catch.hpp>
#include <fstream>
#include <nlohmann/json.hpp>

#include "servo/devices/finder/device_list.hpp"
#include "servo/devices/sim/device_sim.hpp"
#include "tests/servo/support/shape_asset.hpp"

namespace sim_device_test {

using namespace spm;
using namespace spm::servo;

namespace {

/// Positions of a device that feels an asset without the safety stage, and ticks in contact.
struct Felt {
  std::vector<Vector3> positions;
  std::size_t contact = 0;
};

Felt feel(const Asset& asset, const SimOptions& options, std::size_t ticks,
          const ForceSettings& force = {}, double rate_hz = 1000) {
  const AssetTables tables = tables_of(asset);
  DeviceSim device(options);
  const std::array<const AssetView*, 1> assets{&tables.view()};
  const DeviceSetup setup{rate_hz, RealtimeMode::off, scene_of(force), assets};
  const auto opened = device.open(setup);
  REQUIRE(opened);
  Felt felt;
  for (std::size_t i = 0; i < ticks; ++i) {
    DeviceState state;
    REQUIRE(device.read(state) == DeviceHealth::ok);
    const ContactForce contact = contact_force(tables.view(), force, state.position);
    felt.positions.push_back(state.position);
    felt.contact += contact.contact ? 1 : 0;
    REQUIRE(device.write({contact.force, Vector3::Zero()}) == DeviceHealth::ok);
  }
  return felt;
}

}  // namespace

TEST_CASE("Without options the simulated hand touches any shape at least 60 % of the ticks") {
  const auto [name, shape] = GENERATE(table<std::string, test::Shape>(
      {{"box", test::box({0.03, 0.04, 0.05})},
       {"sphere", test::sphere(0.02, 2)},
       {"torus", test::torus(0.02, 0.006, 24, 12)},
       {"thin torus", test::torus(0.02, 0.0015, 24, 8)},
       {"plate of 0.5 mm", test::plate({0.04, 0.04, 0.0005})},
       {"plate of 0.2 mm", test::plate({0.04, 0.04, 0.0002})},
       {"needle", test::box({0.001, 0.001, 0.05})},
       {"wedge", test::wedge(0.3, 0.04)},
       {"two boxes", test::merged(test::box({0.02, 0.02, 0.02}),
                                  test::moved(test::box({0.02, 0.02, 0.02}), {0.025, 0, 0}))}}));
  CAPTURE(name);
  const Asset asset = test::shape_asset(shape);
  for (const std::uint64_t seed : {1U, 2U, 3U}) {
    CAPTURE(seed);
    SimOptions options;
    options.seed = seed;
    REQUIRE(feel(asset, options, 3000).contact >= 1800);
  }
}

TEST_CASE("The simulated hand touches at any rate, with either method and with a ball") {
  const Asset asset = test::box_asset(0.04);
  for (const double rate : {500.0, 4000.0}) {
    const auto ticks = static_cast<std::size_t>(3 * rate);
    REQUIRE(feel(asset, {}, ticks, {}, rate).contact >= ticks * 6 / 10);
  }
  ForceSettings paper;
  paper.method = Method::paper;
  REQUIRE(feel(asset, {}, 3000, paper).contact >= 1800);
  ForceSettings ball;
  ball.probe_radius = 0.5e-3;
  REQUIRE(feel(asset, {}, 3000, ball).contact >= 1800);
}

TEST_CASE("Every profile slides over a sphere in contact") {
  const Asset asset = test::shape_asset(test::sphere(0.02, 2));
  for (const SimProfile& profile : sim_profiles) {
    CAPTURE(std::string(profile.name));
    SimOptions options;
    options.profile = &profile;
    const Felt felt = feel(asset, options, 3000);
    REQUIRE(felt.contact >= 1800);
    double way = 0;
    for (std::size_t i = 1; i < felt.positions.size(); ++i) {
      way += (felt.positions[i] - felt.positions[i - 1]).norm();
    }
    REQUIRE(way > 0.05);
  }
}

TEST_CASE("A pushing hand comes to rest where grip and wall balance") {
  const Asset asset = test::box_asset(0.04);
  SimOptions options;
  options.hand = HandKind::push;
  const Felt felt = feel(asset, options, 3000);
  const double depth = 0.02 - felt.positions.back().cwiseAbs().maxCoeff();
  REQUIRE(depth == Approx(1e-3 * grip_stiffness / (grip_stiffness + 1000)).margin(60e-6));
}

TEST_CASE("The same options and seed give the same ticks, another seed others") {
  const Asset asset = test::shape_asset(test::torus(0.02, 0.006, 24, 12));
  SimOptions options;
  options.seed = 11;
  const Felt first = feel(asset, options, 2000);
  REQUIRE(feel(asset, options, 2000).positions == first.positions);
  options.seed = 12;
  REQUIRE(feel(asset, options, 2000).positions != first.positions);
}

TEST_CASE("The plant's options reach the simulated device, which stays the same again with them") {
  const Asset asset = test::box_asset(0.04);
  SimOptions options;
  options.hand = HandKind::push;
  options.profile = find_sim_profile("falcon");
  const Felt plain = feel(asset, options, 500);
  for (int which = 0; which < 6; ++which) {
    CAPTURE(which);
    SimOptions harder = options;
    if (which == 0) harder.delay_ticks = 1.5;
    if (which == 1) harder.jitter_ticks = 0.5;
    if (which == 2) harder.lost_share = 0.3;
    if (which == 3) harder.noise = 50e-6;
    if (which == 4) harder.mass = MovingMass::falcon;
    if (which == 5) harder.hand_model = HandModel::arm;
    const Felt felt = feel(asset, harder, 500);
    REQUIRE(felt.positions != plain.positions);
    REQUIRE(feel(asset, harder, 500).positions == felt.positions);
    REQUIRE(DeviceSim(harder).describe() != DeviceSim(options).describe());
  }
}

TEST_CASE("A recorded hand leads the tool along its file") {
  const test::TemporaryFolder folder;
  {
    std::ofstream file(folder.file("path.txt"));
    for (int i = 0; i < 1000; ++i) file << 0.03 + i * 1e-5 << " 0 0.05\n";
  }
  const Asset asset = test::box_asset(0.04);
  SimOptions options;
  options.hand = HandKind::recorded;
  options.path = folder.file("path.txt");
  const Felt felt = feel(asset, options, 2000);
  REQUIRE(felt.contact == 0);
  REQUIRE((felt.positions.front() - Vector3(0.03, 0, 0.05)).norm() < 1e-4);
  REQUIRE((felt.positions.back() - Vector3(0.03999, 0, 0.05)).norm() < 2e-4);
}

TEST_CASE("A recorded hand without its file is refused with exit code 2") {
  const Asset asset = test::box_asset(0.04);
  const AssetTables tables = tables_of(asset);
  const std::array<const AssetView*, 1> assets{&tables.view()};
  SimOptions options;
  options.hand = HandKind::recorded;
  options.path = "/nonexistent/path.txt";
  DeviceSim device(options);
  const auto opened = device.open({1000, RealtimeMode::off, scene_of({}), assets});
  REQUIRE_FALSE(opened);
  REQUIRE(opened.error().code == ExitCode::file_or_device);
}

TEST_CASE("An asset without any surface gives the hand nothing to touch, exit code 3") {
  Asset asset = test::box_asset(0.04);
  asset.grid.index.assign(asset.grid.index.size(), 0);
  const AssetTables tables = tables_of(asset);
  const std::array<const AssetView*, 1> assets{&tables.view()};
  DeviceSim device{SimOptions{}};
  const auto opened = device.open({1000, RealtimeMode::off, scene_of({}), assets});
  REQUIRE_FALSE(opened);
  REQUIRE(opened.error().code == ExitCode::invalid_input);
}

TEST_CASE("The simulated hand finds a scene's object where it lies, in the hand's frame") {
  const Asset asset = test::shape_asset(test::sphere(0.02, 2));
  const AssetTables tables = tables_of(asset);
  const std::array<const AssetView*, 1> assets{&tables.view()};
  ForceScene scene = scene_of({});
  scene.objects[0].placement.position = {0.3, -0.2, 0.1};
  scene.objects[0].placement.scale = 2;
  scene.objects[0].effects.friction = {0.4, 0.3, 1000};
  scene.workspace.position = {0.1, 0, 0};
  scene.workspace.rotation = Eigen::AngleAxisd(1, Vector3::UnitY());
  scene.workspace.scale = 1.5;
  DeviceSim device{SimOptions{}};
  REQUIRE(device.open({1000, RealtimeMode::off, scene, assets}));
  SceneForce force(scene, 1e-3, 20e-6);
  std::size_t touching = 0;
  for (int i = 0; i < 3000; ++i) {
    DeviceState state;
    REQUIRE(device.read(state) == DeviceHealth::ok);
    const ContactForce contact = force.next(assets, state.position);
    touching += contact.contact ? 1 : 0;
    REQUIRE(device.write({contact.force, Vector3::Zero()}) == DeviceHealth::ok);
  }
  REQUIRE(touching >= 1800);
}

TEST_CASE("A scene's driver and profile make one device, and the driver's own profile wins") {
  SceneDevice scene;
  REQUIRE(device_of(scene) == "auto");
  REQUIRE(simulated_device_of(scene) == "sim");
  scene.profile = find_device_profile("touch");
  REQUIRE(device_of(scene) == "auto");
  REQUIRE(simulated_device_of(scene) == "sim:profile=touch");
  scene.driver = "auto";
  REQUIRE(device_of(scene) == "auto");
  scene.driver = "simulated";
  REQUIRE(device_of(scene) == "simulated");
  scene.driver = "sim";
  REQUIRE(device_of(scene) == "sim:profile=touch");
  scene.driver = "sim:hand=push";
  REQUIRE(device_of(scene) == "sim:hand=push,profile=touch");
  scene.driver = "sim:profile=low";
  REQUIRE(device_of(scene) == "sim:profile=low");
  scene.driver = "falcon";
  REQUIRE(device_of(scene) == "falcon");
}

TEST_CASE("Unknown devices are usage errors that name the known ones") {
  for (const char* name : {"omega", "", "simulated", "auto:profile=low"}) {
    const auto device = make_device(name);
    REQUIRE_FALSE(device);
    REQUIRE(device.error().code == ExitCode::usage);
    REQUIRE(device.error().message.find("sim") != std::string::npos);
  }
  REQUIRE(make_device("auto"));
  REQUIRE(make_device("sim:profile=falcon"));
}

}  // namespace sim_device_test
