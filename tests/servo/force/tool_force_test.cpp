// SPDX-License-Identifier: Apache-2.0
#include "servo/force/tool_force.hpp"

#include <algorithm>
#include <catch2/catch.hpp>
#include <cmath>
#include <limits>
#include <numbers>

#include "tests/servo/force/tool_scene.hpp"

namespace spm::tool_force_test {
namespace {

using test::ToolScene;

constexpr double rest = ToolScene::tool_size / 2;

Eigen::Quaterniond turned(double angle, const Vector3& axis) {
  return Eigen::Quaterniond(Eigen::AngleAxisd(angle, axis.normalized()));
}

TEST_CASE("A box that is pressed on a table is pushed back by the coupling, without torque") {
  ToolScene scene;
  scene.begin();
  CHECK_FALSE(scene.next({0.001, -0.002, rest + 0.001}).contact);
  const ContactForce contact = scene.settle({0.001, -0.002, rest - 0.002});
  CHECK(contact.contact);
  CHECK(contact.force.z() == Approx(2).epsilon(0.02));
  CHECK(contact.force.head<2>().norm() < 0.02);
  CHECK(contact.torque.norm() < 2e-4);
  CHECK(contact.normal.z() == Approx(1).epsilon(1e-6));
  CHECK(contact.depth == Approx(0.002).epsilon(0.03));
  // What the hand does to the table is the same the other way round, about the table's origin.
  const Wrench& reaction = scene.force->reaction(0);
  CHECK((reaction.force + contact.force).norm() < 0.03);
  const Vector3 place(0.001, -0.002, ToolScene::table_size / 2);
  CHECK((reaction.torque - place.cross(reaction.force)).norm() < 5e-4);
}

TEST_CASE("A peg that is held off its middle feels the torque of its lever") {
  // The hand holds the tool 10 mm beside its middle: the table pushes at the middle.
  ToolScene scene;
  scene.scene.tool->placement.position = {0.01, 0, 0};
  scene.scene.tool->coupling = 800;
  // So stiff that it hardly gives way to the turn.
  scene.turning.inertia = 1;
  scene.scene.tool->turning = 50;
  scene.turning.torque_cap = 5;
  scene.begin();
  scene.settle({-0.01, 0, rest + 0.0005}, Eigen::Quaterniond::Identity(), 5);
  const ContactForce contact = scene.settle({-0.01, 0, rest - 0.001});
  CHECK(contact.force.z() == Approx(0.8).epsilon(0.03));
  // The force is at the edge to which the tool tips: between the middle and the far edge.
  const double lever = -contact.torque.y() / contact.force.z();
  CHECK(lever > 0.003);
  CHECK(lever < 0.0165);
  CHECK(std::abs(contact.torque.x()) < 1e-4);
}

TEST_CASE("A tool tip off the hand's axis gives force and torque as springs in closed form do") {
  // Held at its middle and turned about y by a small angle: the coupling turns it back flat.
  ToolScene scene;
  scene.turning.inertia = 1;
  scene.scene.tool->turning = 1;
  scene.begin();
  constexpr double angle = 0.01;
  scene.settle({0, 0, rest + 0.0005}, Eigen::Quaterniond::Identity(), 5);
  const ContactForce contact = scene.settle({0, 0, rest - 0.003}, turned(angle, Vector3::UnitY()));
  // The box stays flat, since the pressure moves by less than its half size, and feels its spring.
  CHECK(contact.force.z() == Approx(3).epsilon(0.02));
  CHECK(contact.torque.y() == Approx(-angle).epsilon(0.03));
}

TEST_CASE("Without samples there is no force, and the tool is where the hand is") {
  ToolScene scene;
  scene.begin();
  scene.force->take_tool(nullptr, 0);
  const ContactForce contact = scene.next({0, 0, rest - 0.002});
  CHECK_FALSE(contact.contact);
  CHECK(contact.force.isZero());
  CHECK(scene.force->tool().pose.translation().z() == Approx(rest - 0.002));
}

TEST_CASE("A pose that is not one gives nothing and forgets all") {
  ToolScene scene;
  scene.begin();
  scene.settle({0, 0, rest - 0.001});
  const double nan = std::numeric_limits<double>::quiet_NaN();
  CHECK(scene.next({0, nan, rest}).force.isZero());
  scene.settle({0, 0, rest - 0.001});
  CHECK(scene.next({0, 0, rest - 0.001}, Eigen::Quaterniond(1.1, 0, 0, 0)).force.isZero());
  scene.settle({0, 0, rest - 0.001});
  CHECK(scene.next({0, 0, rest - 0.001}, Eigen::Quaterniond(nan, 0, 0, 0)).force.isZero());
}

TEST_CASE(
    "A torque cap of 0 leaves the torque out, and the tool turns as without one of the device") {
  const auto turned_tool = [](double device_cap, double tool_cap, ContactForce& felt) {
    ToolScene scene;
    scene.turning.torque_cap = std::min(device_cap, tool_cap);  // as in a run
    scene.scene.tool->torque_cap = tool_cap;
    scene.begin();
    scene.settle({0, 0, rest + 0.0005}, Eigen::Quaterniond::Identity(), 5);
    scene.settle({0, 0, rest - 0.0002});
    felt = scene.settle({0, 0, rest - 0.0002}, turned(0.4, Vector3::UnitZ()));
    return scene.force->tool().pose;
  };
  ContactForce by_device, by_tool;
  const double none = std::numeric_limits<double>::infinity();
  const Eigen::Isometry3d without = turned_tool(0, none, by_device);
  const Eigen::Isometry3d capped = turned_tool(0.3, 0, by_tool);
  CHECK(std::abs(Eigen::AngleAxisd(capped.linear()).angle()) > 0.38);
  CHECK(capped.matrix() == without.matrix());
  CHECK(by_tool.force.z() > 0.1);
  CHECK(by_tool.force == by_device.force);
  CHECK(by_tool.torque.isZero(0));
}

}  // namespace
}  // namespace spm::tool_force_test
