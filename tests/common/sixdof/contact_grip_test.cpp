// SPDX-License-Identifier: Apache-2.0
// Friction at single samples: bristles, what is kept of them, and their sum.
#include "common/sixdof/contact_grip.hpp"

#include <array>
#include <catch2/catch.hpp>

#include "common/sixdof/virtual_tool.hpp"
#include "tests/support/asset_by_hand.hpp"
#include "tests/support/random.hpp"

namespace spm::contact_grip_test {
namespace {

using Eigen::Isometry3d;
using test::RandomTwister;
using test::SparseCubeByHand;

constexpr GripSettings rough{0.2, 0.15, 1};
constexpr double force = 0.01, spring = 1000;  // N, N/m: of a sample

/// The end of a tick in which so many samples touch each of so many objects, all moved by `moved`
/// along the surface.
void settle(ContactGrip& grip, std::uint32_t samples, std::uint32_t objects, double moved) {
  grip.begin();
  for (std::uint32_t object = 0; object < objects; ++object) {
    grip.begin(object);
    for (std::uint32_t sample = 0; sample < samples; ++sample) {
      const Vector3 place(1e-3 * sample + moved, 0.02 * object, 0);
      // In a row, as neighbours have it.
      grip.settle(rough, 1000 * object + sample, object, place, place, Vector3::UnitZ(), force,
                  spring);
    }
    grip.end(object, samples * force);
  }
}

TEST_CASE("Each of a thousand samples that touch several objects at once keeps its anchor") {
  ContactGrip grip(30'000, 5);
  settle(grip, 200, 5, 0);
  CHECK(grip.moved());
  settle(grip, 200, 5, 0);
  CHECK_FALSE(grip.moved());
  // Less than gives way.
  settle(grip, 200, 5, 1e-6);
  CHECK_FALSE(grip.moved());
  for (const std::uint32_t object : {0U, 4U}) {
    const Vector3 place(1e-3 * 7 + 1e-6, 0.02 * object, 0);
    const Bristle bristle = grip.bristle(1000 * object + 7, object, place, place, Vector3::UnitZ());
    CHECK(bristle.stretch.x() == Approx(1e-6).epsilon(1e-3));
  }
}

TEST_CASE("A bristle that gave way is at rest as soon as its sample is, to the bit") {
  ContactGrip grip(1000, 1);
  settle(grip, 50, 1, 0);
  for (const double moved : {3e-6, 7.123456e-6, 1.9e-5}) {
    settle(grip, 50, 1, moved);
    CHECK(grip.moved());
    settle(grip, 50, 1, moved);
    CHECK_FALSE(grip.moved());
    const Vector3 place(1e-3 * 3 + moved, 0, 0);
    const Bristle bristle = grip.bristle(3, 0, place, place, Vector3::UnitZ());
    CHECK(spring * bristle.stretch.norm() == Approx(rough.slide * force).epsilon(1e-5));
  }
}

TEST_CASE("What slid sticks again once it pulls with less than what slides, as well as before") {
  ContactGrip grip(1000, 1);
  const auto pull_after = [&](double moved) {
    settle(grip, 50, 1, moved);
    const Vector3 place(1e-3 * 3 + moved, 0, 0);
    return spring * grip.bristle(3, 0, place, place, Vector3::UnitZ()).stretch.x();
  };
  const double slides = rough.slide * force, sticks = rough.stick * force;
  CHECK(pull_after(0) == Approx(0).margin(1e-9));
  CHECK(pull_after(5e-6) == Approx(slides).epsilon(1e-3));
  // Back by half of the stretch, and then to between the two limits: it holds.
  CHECK(pull_after(4.25e-6) == Approx(slides / 2).epsilon(1e-2));
  CHECK(pull_after(5.25e-6) == Approx((slides + sticks) / 2).epsilon(1e-2));
  CHECK(pull_after(5.6e-6) == Approx(slides).epsilon(1e-3));
}

// More samples touch than are remembered.
TEST_CASE("A tool that lies on a rough object is not looked at again while nothing changes") {
  constexpr double size = 0.04, tool_size = 0.012;
  const SparseCubeByHand cube(size);
  const SurfaceSamples samples = *sample_surface(SparseCubeByHand(tool_size).view, 0.0003);
  ObjectContactSettings settings;
  settings.stiffness = 5e10;
  ObjectContact contact(samples, settings);
  VirtualTool tool(contact, VirtualToolSettings{}, tool_size);
  std::array<ContactObject, 1> objects;
  objects[0].field = &cube.view;
  objects[0].grip = rough;
  VirtualToolBudget budget;
  budget.same_objects = true;
  const double rest = (size + tool_size) / 2;
  tool.place(Isometry3d(Eigen::Translation3d(0, 0, rest + 1e-4)));
  const auto tick = [&](double aside) {
    const VirtualToolReport report =
        tool.tick(Isometry3d(Eigen::Translation3d(aside, 0, rest - 1e-3)), objects, budget);
    contact.settle();
    return report;
  };
  for (int i = 0; i < 50; ++i) static_cast<void>(tick(0));
  const VirtualToolReport lies = tick(0);
  CHECK(lies.looks == 0);
  CHECK(lies.contact.sum.contacts > 1000);
  CHECK(lies.wrench.force.z() == Approx(1).epsilon(0.02));
  // It holds, slides, and lies again.
  CHECK(tick(1e-4).wrench.force.x() < -0.05);
  for (int i = 0; i < 450; ++i) static_cast<void>(tick(1e-4 + 2e-6 * i));
  CHECK(tick(1.1e-3).looks > 0);
  for (int i = 0; i < 50; ++i) static_cast<void>(tick(1.1e-3));
  const VirtualToolReport again = tick(1.1e-3);
  CHECK(again.looks == 0);
  CHECK(-again.wrench.force.x() <= 1.05 * rough.stick * again.wrench.force.z());
  CHECK(-again.wrench.force.x() >= 0.8 * rough.slide * again.wrench.force.z());
}

TEST_CASE("A spring along the surface is two springs that are across its normal and each other") {
  RandomTwister random(7);
  for (int i = 0; i < 50; ++i) {
    const Vector3 normal = random.direction(), arm = 0.02 * random.direction();
    const Vector3 first = normal.unitOrthogonal(), second = normal.cross(first);
    const Vector3 pull = 1e-5 * (0.3 * first - 0.7 * second);
    const bool gives_way = i % 2 == 1;
    ContactSum sum, wanted;
    sum.add_along(spring, pull, normal, arm, 0.5, gives_way);
    if (gives_way) {
      wanted.add(spring, 0, 0, 1, normal.cross(pull.normalized()), arm);
    } else {
      wanted.add(spring, 0, 0, 1, first, arm);
      wanted.add(spring, 0, 0, 1, second, arm);
    }
    const Matrix6 found = sum.stiffness.selfadjointView<Eigen::Lower>();
    const Matrix6 made = wanted.stiffness.selfadjointView<Eigen::Lower>();
    CHECK((found - made).cwiseAbs().maxCoeff() < 1e-9 * spring);
    CHECK((sum.forces().force - spring * pull).norm() < 1e-12);
    CHECK((sum.forces().torque - arm.cross(spring * pull)).norm() < 1e-12);
    CHECK(sum.energy == 0.5);
  }
}

}  // namespace
}  // namespace spm::contact_grip_test
