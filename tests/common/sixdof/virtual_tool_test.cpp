// SPDX-License-Identifier: Apache-2.0
#include "common/sixdof/virtual_tool.hpp"

#include <algorithm>
#include <array>
#include <catch2/catch.hpp>
#include <cmath>

#include "tests/support/asset_by_hand.hpp"

namespace spm::virtual_tool_test {
namespace {

using Eigen::Isometry3d;
using test::SparseCubeByHand;

constexpr double size = 0.04, tool_size = 0.012;

/// A small cube as the tool, above an object.
struct Scene {
  explicit Scene(const SparseCubeByHand& object)
      : samples(*sample_surface(SparseCubeByHand(tool_size).view, 0.0006)),
        contact(samples, settings()),
        tool(contact, VirtualToolSettings{}, tool_size),
        objects{ContactObject{&object.view, Isometry3d::Identity()}} {}
  Scene(const Scene&) = delete;
  Scene& operator=(const Scene&) = delete;
  static ObjectContactSettings settings() {
    ObjectContactSettings made;
    made.stiffness = 5e10;
    return made;
  }
  VirtualToolReport tick(const Isometry3d& device) { return tool.tick(device, objects); }

  SurfaceSamples samples;
  ObjectContact contact;
  VirtualTool tool;
  std::array<ContactObject, 1> objects;
};

Isometry3d at(double x, double y, double z) { return Isometry3d(Eigen::Translation3d(x, y, z)); }

/// A plate of this thickness across z.
void make_plate(SparseCubeByHand& cube, double thickness) {
  for (std::size_t k : {4U, 5U}) cube.planes[k].x0 *= thickness / size;
  cube.replace_triangles(test::box({size, size, thickness}));
}

TEST_CASE("Where nothing is near the tool follows the device, and there is no force") {
  const SparseCubeByHand cube(size);
  Scene scene(cube);
  scene.tool.place(at(0, 0, 0.05));
  for (int tick = 0; tick < 200; ++tick) {
    const double t = tick * 0.001;
    const Isometry3d device = at(0.01 * std::sin(40 * t), 0, 0.05 + 0.01 * std::cos(30 * t)) *
                              Eigen::AngleAxisd(3 * t, Vector3(1, 2, 2).normalized());
    const VirtualToolReport report = scene.tick(device);
    REQUIRE(report.wrench.force.norm() < 1e-5);
    REQUIRE(report.wrench.torque.norm() < 1e-6);
    REQUIRE(report.pose.isApprox(device, 1e-6));
  }
}

TEST_CASE("A box pressed on a plane is held by the coupling's force, without drift") {
  const SparseCubeByHand cube(size);
  Scene scene(cube);
  const double rest = (size + tool_size) / 2;
  scene.tool.place(at(0.002, -0.001, rest + 0.001));
  Isometry3d settled;
  for (int tick = 0; tick < 600; ++tick) {
    const double down = std::min(0.003, tick * 2e-5);
    const VirtualToolReport report = scene.tick(at(0.002, -0.001, rest + 0.001 - down));
    if (tick == 300) settled = report.pose;
    if (tick < 300) continue;
    REQUIRE(report.balanced);
    REQUIRE(report.wrench.force.z() == Approx(2).epsilon(0.02));  // 2 mm below rest, 1 N/mm
    REQUIRE(report.wrench.force.head<2>().norm() < 0.02);
    REQUIRE((report.pose.translation() - settled.translation()).norm() < 1e-6);
  }
  // It gives way by no more than the contact's own stiffness says, and lets go without sticking.
  CHECK(settled.translation().z() == Approx(rest).margin(2e-5));
  VirtualToolReport report;
  for (int tick = 0; tick < 200; ++tick) {
    report = scene.tick(at(0.002, -0.001, rest - 0.002 + tick * 5e-5));
  }
  CHECK(report.wrench.force.norm() < 1e-5);
}

TEST_CASE("However deep the device goes the wrench is bounded, and the tool stays outside") {
  const SparseCubeByHand cube(size);
  Scene scene(cube);
  scene.tool.place(at(0, 0, 0.03));
  const VirtualToolSettings bounds;
  for (int tick = 0; tick < 300; ++tick) {
    const Isometry3d device =
        at(0, 0, 0.03 - tick * 2e-4) * Eigen::AngleAxisd(0.004 * tick, Vector3::UnitX());
    const VirtualToolReport report = scene.tick(device);
    REQUIRE(report.wrench.force.norm() <= bounds.max_force * 1.0001);
    REQUIRE(report.contact.sum.deepest < 5e-4);
  }
}

TEST_CASE("A spring that met its cap holds the work that was done on it") {
  const SparseCubeByHand cube(size);
  Scene scene(cube);
  const VirtualToolSettings bounds;
  const double rest = (size + tool_size) / 2;
  scene.tool.place(at(0, 0, rest + 0.0005));
  VirtualToolReport report;
  for (int tick = 0; tick < 400; ++tick) {
    report = scene.tick(at(0, 0, rest + 0.0005 - std::min(0.0205, tick * 1e-4)));
  }
  REQUIRE(report.capped);
  const double stretch = report.pose.translation().z() - (rest - 0.02);
  REQUIRE(stretch > 0.0195);
  // Linear up to the cap, from there on the cap.
  const double up_to = bounds.max_force / bounds.stiffness;
  const double spring = bounds.max_force * up_to / 2 + bounds.max_force * (stretch - up_to);
  CHECK(report.energy - report.contact.sum.energy == Approx(spring).epsilon(1e-6));
}

TEST_CASE("A plate of 0.2 mm is not passed at 1 m/s, there and back") {
  SparseCubeByHand plate(size);
  make_plate(plate, 0.0002);
  for (const double tilt : {0.0, 0.3}) {
    Scene scene(plate);
    const auto device = [&](double z) {
      return at(0.001, 0.002, z) * Eigen::AngleAxisd(tilt, Vector3(1, 0.5, 0).normalized());
    };
    scene.tool.place(device(0.015));
    VirtualToolReport report;
    for (int tick = 0; tick < 100; ++tick) {
      report = scene.tick(device(std::max(0.015 - tick * 0.001, -0.012)));
      REQUIRE(report.pose.translation().z() > tool_size / 2 - 2e-4);
    }
    CHECK(report.wrench.force.z() > 4);
    for (int tick = 0; tick < 60; ++tick) {
      report = scene.tick(device(std::min(-0.012 + tick * 0.001, 0.015)));
    }
    CHECK(report.wrench.force.norm() < 1e-3);
  }
}

TEST_CASE("After a tick that had no time for the finest level the next looks at it, even at rest") {
  const SparseCubeByHand cube(size);
  Scene scene(cube);
  const double rest = (size + tool_size) / 2;
  scene.tool.place(at(0, 0, rest - 0.00001));
  const auto finest = static_cast<std::uint32_t>(scene.samples.levels.size() - 1);
  const auto tick = [&](const VirtualToolBudget& budget) {
    return scene.tool.tick(at(0, 0, rest - 0.0001), scene.objects, budget);
  };
  VirtualToolBudget short_of_time;
  short_of_time.refine_work = 20;
  const VirtualToolReport coarse = tick(short_of_time);
  REQUIRE(coarse.contact.level < finest);
  REQUIRE(coarse.steps > 0);
  VirtualToolBudget enough;
  enough.same_objects = true;
  CHECK(tick(enough).contact.level == finest);
}

TEST_CASE("A device that is nowhere moves nothing and gives no wrench") {
  const SparseCubeByHand cube(size);
  Scene scene(cube);
  scene.tool.place(at(0, 0, 0.05));
  const VirtualToolReport report = scene.tick(at(NAN, 0, 0));
  CHECK(report.wrench.force.isZero());
  CHECK(report.pose.translation().z() == 0.05);
}

}  // namespace
}  // namespace spm::virtual_tool_test
