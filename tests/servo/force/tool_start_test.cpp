// SPDX-License-Identifier: Apache-2.0
// How a tool begins, and what it makes of poses, scales and assets that are none.
#include <catch2/catch.hpp>
#include <cmath>
#include <limits>
#include <numbers>

#include "tests/servo/force/tool_scene.hpp"

namespace spm::tool_start_test {
namespace {

using test::SparseCubeByHand;
using test::ToolScene;

constexpr double rest = ToolScene::tool_size / 2;

Eigen::Quaterniond turned(double angle, const Vector3& axis) {
  return Eigen::Quaterniond(Eigen::AngleAxisd(angle, axis.normalized()));
}

TEST_CASE("A tool that begins inside an object is pushed out the short way, without a kick") {
  ToolScene scene;
  scene.begin();
  double last = 0, most_step = 0;
  ContactForce contact;
  for (int tick = 0; tick < 400; ++tick) {
    contact = scene.next({0.001, 0.002, rest - 0.0018});
    most_step = std::max(most_step, std::abs(contact.force.norm() - last));
    last = contact.force.norm();
  }
  // The coupling's force grows by no more than a short step a tick stretches it.
  CHECK(most_step < 0.06);
  CHECK(contact.force.z() == Approx(1.8).epsilon(0.03));
  CHECK(contact.force.head<2>().norm() < 0.03);
  CHECK(scene.force->tool().pose.translation().z() == Approx(rest).margin(5e-5));
}

TEST_CASE("A hand that turns by half a turn in a tick meets its caps, and its tool follows") {
  ToolScene scene;
  scene.begin();
  scene.settle({0, 0, rest - 0.001});
  const ContactForce contact =
      scene.next({0, 0, rest - 0.001}, turned(std::numbers::pi, Vector3::UnitX()));
  CHECK(contact.force.allFinite());
  CHECK(contact.torque.norm() <= scene.turning.torque_cap * (1 + 1e-9));
  CHECK(contact.force.norm() <= scene.turning.force_cap * (1 + 1e-9));
  CHECK(scene.force->tool().capped);
  // In the air it is there at once.
  ToolScene free;
  free.begin();
  free.settle({0, 0, 0.05}, Eigen::Quaterniond::Identity(), 3);
  const Eigen::Quaterniond half = turned(std::numbers::pi, Vector3::UnitX());
  CHECK(free.settle({0, 0, 0.05}, half, 3).torque.norm() < 1e-6);
  CHECK(free.force->tool().pose.linear().isApprox(half.toRotationMatrix(), 1e-6));
}

TEST_CASE("A coupling stiffer than the device bears is held to what it bears") {
  ToolScene scene;
  scene.scene.tool->coupling = 1e5;
  scene.scene.tool->turning = 1e3;
  ToolLoop loop;
  loop.limits.stiffness = 1500;
  loop.turning = {true, 0.2, 0, 1e-4, 8};
  const ToolCoupling coupling = tool_coupling(*scene.scene.tool, loop);
  CHECK(coupling.stiffness == 1500);
  // As stable for the inertia as the stiffness is for the mass.
  CHECK(coupling.turning == Approx(1500 * 1e-4 / 0.1));
  CHECK(coupling.force_cap == 8);
  CHECK(coupling.torque_cap == 0.2);
  CHECK(coupling.torque);
  loop.turning.torque_cap = 0;
  CHECK_FALSE(tool_coupling(*scene.scene.tool, loop).torque);
  CHECK(std::isfinite(tool_coupling({}, {}).force_cap));
  CHECK(std::isfinite(tool_coupling({}, {}).torque_cap));
}

TEST_CASE("The torque's cap is met by a turn of three degrees, and by no less") {
  ToolSettings tool;
  tool.coupling = 1000;
  tool.turning = 100;
  ToolLoop loop;
  // So much inertia that it bounds nothing.
  loop.turning = {true, 0.2, 0, 1, 8};
  CHECK(tool_coupling(tool, loop).turning == Approx(0.2 / 0.05));
  tool.torque_cap = 0.1;
  CHECK(tool_coupling(tool, loop).turning == Approx(0.1 / 0.05));
}

TEST_CASE("The chosen coupling is so soft that a tool's certified error is hardly felt") {
  // A tenth of 8 N at 2 mm of error: 400 N/m in place of 1000.
  for (const double tolerance : {1e-5, 2e-3}) {
    ToolScene scene;
    scene.tool_cube.view.tolerance = tolerance;
    scene.begin();
    scene.settle({0, 0, rest + 0.003}, Eigen::Quaterniond::Identity(), 20);
    const double force = scene.settle({0, 0, rest - 0.001}).force.z();
    CHECK(force == Approx(tolerance > 1e-3 ? 0.4 : 1).epsilon(0.05));
  }
  ToolLoop loop;
  loop.error = 2e-3;
  loop.turning.force_cap = 8;
  CHECK(tool_coupling({}, loop).stiffness == Approx(400));
  // What is named is meant.
  ToolSettings named;
  named.coupling = 900;
  CHECK(tool_coupling(named, loop).stiffness == 900);
}

TEST_CASE("Tools and objects of a millionth and of a million times their size give finite forces") {
  for (const double scale : {1e-6, 1e6}) {
    ToolScene scene;
    scene.scene.tool->placement.scale = scale;
    scene.scene.objects[0].placement.scale = scale;
    scene.scene.objects[0].placement.position *= scale;
    scene.begin();
    const double top = scale * rest;
    scene.settle({0, 0, top * 1.2}, Eigen::Quaterniond::Identity(), 3);
    for (int tick = 0; tick < 50; ++tick) {
      const ContactForce contact = scene.next({0, 0, top * (1.2 - 0.01 * tick)});
      REQUIRE(contact.force.allFinite());
      REQUIRE(contact.torque.allFinite());
      REQUIRE(contact.force.norm() <= scene.turning.force_cap * (1 + 1e-9));
    }
    // A small tool beside a large table, which is a plane for it, rests on it.
    ToolScene mixed;
    mixed.scene.tool->placement.scale = scale < 1 ? 1e-3 : 1;
    mixed.scene.objects[0].placement.scale = 1e3;
    mixed.scene.objects[0].placement.position = {0.001, 0.002, -1e3 * ToolScene::table_size / 2};
    mixed.begin();
    const double half = mixed.scene.tool->placement.scale * rest;
    mixed.settle({0, 0, half + 0.001}, Eigen::Quaterniond::Identity(), 3);
    CHECK(mixed.settle({0, 0, half - 0.001}).force.z() == Approx(1).epsilon(0.05));
  }
}

TEST_CASE("A tool that is smaller than an object's error has few samples, and slides freely") {
  for (const double scale : {1e-6, 1e-3}) {
    ToolScene scene;
    scene.scene.tool->placement.scale = scale;
    scene.scene.tool->spacing = 0;
    scene.begin();
    CHECK(scene.sampled->samples().levels.back().count < 200);
    scene.settle({0, 0, 0.0003}, Eigen::Quaterniond::Identity(), 20);
    scene.settle({0, 0, -0.0004});
    ContactForce contact;
    for (int tick = 0; tick < 200; ++tick) contact = scene.next({2e-5 * tick, 0, -0.0004});
    INFO("scale " << scale << ", force " << contact.force.transpose());
    CHECK(contact.force.z() == Approx(0.4).epsilon(0.1));
    CHECK(contact.force.head<2>().norm() < 0.05);
  }
}

TEST_CASE("A tool larger than any workspace presses, tilts and turns within the device's caps") {
  // 1.2 m long, with samples 60 mm apart, on a table of 0.4 m.
  ToolScene scene;
  scene.scene.tool->placement.scale = 100;
  // The one that is chosen would be softer, since the tool's error is 100 times its own as well.
  scene.scene.tool->coupling = 1000;
  scene.scene.objects[0].placement.scale = 10;
  scene.scene.objects[0].placement.position *= 10;
  scene.begin();
  const double half = 100 * rest;
  scene.settle({0, 0, half + 0.0005}, Eigen::Quaterniond::Identity(), 20);
  CHECK(scene.settle({0, 0, half - 0.001}).force.z() == Approx(1).epsilon(0.05));
  // Its far end goes round by metres, or lies on the table with the hand out of all reach.
  for (int tick = 0; tick < 300; ++tick) {
    const double angle = 0.01 * tick;
    const Vector3 hand(0.3 * std::sin(angle), 0.3 * std::sin(0.7 * angle), half - 0.005);
    const ContactForce contact = scene.next(hand, turned(angle, {1, 2, 3}));
    REQUIRE(contact.force.allFinite());
    REQUIRE(contact.torque.allFinite());
    REQUIRE(contact.force.norm() <= scene.turning.force_cap * (1 + 1e-9));
    REQUIRE(contact.torque.norm() <= scene.turning.torque_cap * (1 + 1e-9));
  }
  // And it comes free again.
  CHECK(scene.settle({0, 0, 4 * half}, Eigen::Quaterniond::Identity(), 500).force.norm() < 1e-9);
}

TEST_CASE("A tool's scale makes it larger, and so does that of an object") {
  ToolScene scene;
  scene.scene.tool->placement.scale = 2;
  scene.scene.objects[0].placement.scale = 3;
  scene.scene.objects[0].placement.position *= 3;
  scene.begin();
  CHECK_FALSE(scene.next({0, 0, 2 * rest + 0.0005}).contact);
  CHECK(scene.settle({0, 0, 2 * rest - 0.001}).force.z() == Approx(1).epsilon(0.03));
  // Beyond the table's unscaled border.
  scene.settle({0.05, 0, 2 * rest + 0.0005}, Eigen::Quaterniond::Identity(), 50);
  CHECK(scene.settle({0.05, 0, 2 * rest - 0.001}).force.z() == Approx(1).epsilon(0.03));
}

TEST_CASE("A workspace's scale and turn take force and torque along, and no energy is made") {
  // One metre of the hand is half a metre of the world, and the world is turned about x.
  ToolScene plain, scaled;
  plain.scene.tool->coupling = 1000;
  plain.scene.tool->turning = 0.4;
  plain.turning = scaled.turning = {true, 10, 0, 1, 100};
  const Eigen::Quaterniond turn = turned(0.7, Vector3::UnitX());
  scaled.scene.workspace.rotation = turn;
  scaled.scene.workspace.scale = 0.5;
  // The same springs in the world.
  scaled.scene.tool->coupling = 500;
  scaled.scene.tool->turning = 0.8;
  plain.begin();
  scaled.begin();
  const Eigen::Quaterniond pose = turned(0.004, {1, 2, 0});
  ContactForce wanted, found;
  for (int tick = 0; tick < 300; ++tick) {
    const Vector3 at(0.001, 0.0005, rest + 0.0005 - std::min(0.002, 1e-5 * tick));
    wanted = plain.next(at, pose);
    found = scaled.next(turn.conjugate() * at / 0.5, turn.conjugate() * pose);
  }
  CHECK(wanted.force.z() > 1);
  CHECK(wanted.torque.norm() > 1e-4);
  CHECK((turn * found.force - wanted.force).norm() < 0.01 * wanted.force.norm());
  // Newtons stay, lengths double, and so do levers.
  CHECK((turn * found.torque * 0.5 - wanted.torque).norm() < 0.05 * wanted.torque.norm());
}

TEST_CASE("An asset without surface, inside or as many samples as a tick can look at is refused") {
  const SparseCubeByHand cube(0.012);
  ToolSettings settings;
  settings.spacing = 0.0006;
  CHECK(SampledTool::make(cube.view, settings, 1, 1).has_value());
  AssetView empty;
  CHECK_FALSE(SampledTool::make(empty, settings, 1, 1).has_value());
  SparseCubeByHand empty_list(0.012);
  empty_list.replace_triangles({});
  CHECK_FALSE(SampledTool::make(empty_list.view, settings, 1, 1).has_value());
  settings.spacing = 0;
  settings.samples = 5'000'000;
  CHECK_FALSE(SampledTool::make(cube.view, settings, 1, 1).has_value());
  settings.samples = 3000;
  const auto made = SampledTool::make(cube.view, settings, 1, 1);
  REQUIRE(made.has_value());
  CHECK((*made)->samples().levels.back().count <= 3000);
  CHECK((*made)->samples().levels.back().count > 1500);
  settings.placement.scale = 0;
  CHECK_FALSE(SampledTool::make(cube.view, settings, 1, 1).has_value());
}

TEST_CASE("A tool that is exchanged begins where the old one was") {
  ToolScene scene;
  scene.begin();
  scene.settle({0, 0, rest - 0.002});
  const Vector3 held = scene.force->tool().pose.translation();
  auto other = SampledTool::make(scene.tool_cube.view, *scene.scene.tool, 1, 1);
  REQUIRE(other.has_value());
  scene.force->take_tool(other->get(), 0);
  const ContactForce contact = scene.next({0, 0, rest - 0.002});
  CHECK((scene.force->tool().pose.translation() - held).norm() < 1e-4);
  CHECK(contact.force.z() == Approx(2).epsilon(0.05));
}

}  // namespace
}  // namespace spm::tool_start_test
