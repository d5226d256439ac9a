// SPDX-License-Identifier: Apache-2.0
// A tool among several objects: which of them are looked at in a tick.
#include <algorithm>
#include <array>
#include <catch2/catch.hpp>

#include "common/sixdof/object_contact.hpp"
#include "tests/support/asset_by_hand.hpp"

namespace spm::object_crowd_test {
namespace {

using Eigen::Isometry3d;
using test::SparseCubeByHand;

constexpr double object_size = 0.01, tool_size = 0.012, ahead = 1e-4;
constexpr std::uint32_t pressed = 2;  ///< number of the object below the tool

Isometry3d at(const Vector3& place) { return Isometry3d(Eigen::Translation3d(place)); }

struct Crowd {
  explicit Crowd(double gap) {
    const double away = (object_size + tool_size) / 2;
    for (const double side : {-1.0, 1.0}) {
      for (Eigen::Index axis = 0; axis < 3; ++axis) {
        ContactObject& object = objects[count++];
        object.field = &cube.view;
        object.pose = at((away + gap) * side * Vector3::Unit(axis));
      }
    }
    cube.forget_box();
    // The tool is pressed on the one below.
    objects[pressed].pose = at((away - 2e-5) * -Vector3::UnitZ());
    settings.objects = static_cast<std::uint32_t>(objects.size());
  }
  /// So that the field alone tells what is clear.
  void forget_planes() { cube.view.planes = {}; }
  Crowd(const Crowd&) = delete;
  Crowd& operator=(const Crowd&) = delete;
  SparseCubeByHand cube{object_size};
  SurfaceSamples tool = *sample_surface(SparseCubeByHand(tool_size).view, 0.0003);
  std::array<ContactObject, 6> objects;
  std::size_t count = 0;
  ObjectContactSettings settings;
};

/// N, of the object below.
double force_of_pressed(const ObjectContact& contact) {
  double force = 0;
  for (const PressedPatch& patch : contact.patches()) {
    if (patch.object == pressed) force += patch.force.z();
  }
  return force;
}

TickBudget listing() {
  TickBudget budget;
  budget.ahead = ahead;
  budget.whole_levels = true;
  return budget;
}

TEST_CASE("Where time ends among several objects the next ticks go on there, to the same force") {
  Crowd crowd(1.5e-4);
  crowd.forget_planes();
  ObjectContact contact(crowd.tool, crowd.settings), whole(crowd.tool, crowd.settings);
  const ObjectContactReport wanted = whole.tick(Isometry3d::Identity(), crowd.objects, listing());
  REQUIRE(wanted.sum.contacts > 100);
  TickBudget little = listing();
  little.work = wanted.worked / 2;
  ObjectContactReport report = contact.tick(Isometry3d::Identity(), crowd.objects, little);
  CHECK(report.stopped);
  CHECK(report.unresolved > 1);
  int ticks = 1;
  while (report.unresolved > 0) {
    const std::uint32_t before = report.unresolved;
    contact.keep();
    report = contact.tick(Isometry3d::Identity(), crowd.objects, little);
    REQUIRE(report.unresolved < before);
    ++ticks;
  }
  CHECK(ticks > 1);
  CHECK_FALSE(report.degraded);
  CHECK(report.level == wanted.level);
  CHECK(report.sum.contacts == wanted.sum.contacts);
}

TEST_CASE(
    "Where time ends the objects that pressed before are looked at first, to the same force") {
  Crowd crowd(1.5e-4);
  crowd.forget_planes();
  ObjectContact contact(crowd.tool, crowd.settings);
  const ObjectContactReport whole = contact.tick(Isometry3d::Identity(), crowd.objects, listing());
  contact.keep();
  const double wanted = force_of_pressed(contact);
  REQUIRE(wanted > 1);
  // A list for another way is of no use: all are looked at anew.
  TickBudget little = listing();
  little.ahead = 1.1 * ahead;
  little.work = whole.worked / 8;
  const ObjectContactReport report = contact.tick(Isometry3d::Identity(), crowd.objects, little);
  CHECK(report.unresolved > 0);
  contact.keep();
  CHECK(force_of_pressed(contact) == Approx(wanted).epsilon(1e-7));
}

TEST_CASE("Where the field ends a sample is as far off as the object's box, and not asked") {
  Crowd crowd(5e-4);
  crowd.forget_planes();
  ObjectContact anywhere(crowd.tool, crowd.settings), boxed(crowd.tool, crowd.settings);
  const ObjectContactReport all = anywhere.tick(Isometry3d::Identity(), crowd.objects, listing());
  crowd.cube.view.box_low.setConstant(-object_size / 2);
  crowd.cube.view.box_high.setConstant(object_size / 2);
  const ObjectContactReport some = boxed.tick(Isometry3d::Identity(), crowd.objects, listing());
  CHECK(some.asked < all.asked);
  CHECK(some.sum.contacts == all.sum.contacts);
  CHECK(some.sum.wrench == all.sum.wrench);
}

TEST_CASE(
    "An object that a support plane or a side of its box parts from the tool asks no sample") {
  Crowd crowd(2e-4);
  SECTION("planes") {}
  SECTION("box") {
    crowd.cube.view.planes = {};
    crowd.cube.view.box_low.setConstant(-object_size / 2);
    crowd.cube.view.box_high.setConstant(object_size / 2);
  }
  ObjectContact contact(crowd.tool, crowd.settings);
  // The last of them alone: the one above.
  for (std::size_t i = 0; i + 1 < crowd.objects.size(); ++i) crowd.objects[i].field = nullptr;
  const ObjectContactReport apart = contact.tick(Isometry3d::Identity(), crowd.objects, listing());
  CHECK(apart.asked == 0);
  CHECK(apart.clearance > ahead);
  CHECK(apart.clearance <= 2e-4);
  // Nearer than it knows, it is looked at.
  const ObjectContactReport touching = contact.tick(at({0, 0, 2.2e-4}), crowd.objects, listing());
  CHECK(touching.asked > 100);
  CHECK(touching.sum.contacts > 100);
}

TEST_CASE("Of several objects that a tool moves among one is looked at anew in a tick") {
  Crowd crowd(1.5e-4);
  crowd.forget_planes();
  ObjectContact contact(crowd.tool, crowd.settings);
  const ObjectContactReport first = contact.tick(Isometry3d::Identity(), crowd.objects, listing());
  std::uint32_t most = 0;
  for (int tick = 1; tick < 100; ++tick) {
    const ObjectContactReport report =
        contact.tick(at({2e-6 * std::min(tick, 100 - tick), 0, 0}), crowd.objects, listing());
    most = std::max(most, report.worked);
    REQUIRE(report.level + 1 == crowd.tool.levels.size());
  }
  CHECK(most < first.worked / 2);
}

}  // namespace
}  // namespace spm::object_crowd_test
