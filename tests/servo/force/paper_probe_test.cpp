// SPDX-License-Identifier: Apache-2.0
#include <array>
#include <catch2/catch.hpp>
#include <cmath>
#include <numbers>

#include "servo/force/scene_force.hpp"
#include "tests/support/asset_by_hand.hpp"

namespace spm::paper_probe_test {
namespace {

using Assets = std::array<const AssetView*, 1>;

constexpr double tick = 1e-3;
const Vector3 size(0.04, 0.04, 0.04);
/// As a bake for balls of up to 2 mm has it.
constexpr Band band{0.002, 0.0025};

/// The box by the paper, 1 N/mm, without effects.
PlacedObject object_of(const ProbeShape& probe) {
  PlacedObject object;
  object.force.method = Method::paper;
  object.force.take_probe(probe);
  return object;
}

const ProbeShape ball{ProbeKind::ball, 2e-3, 0};
const ProbeShape capsule{ProbeKind::capsule, 1e-3, 0.01};

Eigen::Quaterniond about(const Vector3& axis, double angle) {
  return Eigen::Quaterniond(Eigen::AngleAxisd(angle, axis));
}

TEST_CASE("A capsule stays with the hand: turning the object turns the contact, not the capsule") {
  const test::BoxByHand box(size, band);
  ForceScene scene;
  scene.objects = {object_of(capsule)};
  SceneForce force(scene, tick, 0);
  // Over the top the capsule stands, and its end is 6 mm below its middle.
  CHECK(force.next(Assets{&box.view}, {0, 0, 0.0259}).contact);
  CHECK_FALSE(force.next(Assets{&box.view}, {0, 0, 0.0261}).contact);
  // Beside a wall it hangs, and touches along its side.
  CHECK_FALSE(force.next(Assets{&box.view}, {0.0211, 0, 0}).contact);
  CHECK(force.next(Assets{&box.view}, {0.0209, 0, 0}).contact);
  // The same with the box turned by a quarter: what is above is another face now.
  force.place(0, Vector3::Zero(), about(Vector3::UnitX(), std::numbers::pi / 2));
  const ContactForce found = force.next(Assets{&box.view}, {0, 0, 0.0259});
  CHECK(found.contact);
  CHECK((found.normal - Vector3::UnitZ()).norm() < 1e-9);
  CHECK_FALSE(force.next(Assets{&box.view}, {0, 0, 0.0261}).contact);
}

TEST_CASE("A workspace that is turned turns the capsule in the world") {
  const test::BoxByHand box(size, band);
  ForceScene scene;
  scene.objects = {object_of(capsule)};
  scene.workspace.rotation = about(Vector3::UnitY(), std::numbers::pi / 2);
  SceneForce force(scene, tick, 0);
  const auto contact_at = [&](const Vector3& world) {
    return force.next(Assets{&box.view}, scene.workspace.from_world(world)).contact;
  };
  // The hand's z is the world's x: the capsule lies on the top.
  CHECK_FALSE(contact_at({0, 0, 0.0211}));
  CHECK(contact_at({0, 0, 0.0209}));
  CHECK(contact_at({0.0259, 0, 0}));
  CHECK_FALSE(contact_at({0.0261, 0, 0}));
}

TEST_CASE("The sizes of a probe are those of the world, whatever the object's scale") {
  const test::BoxByHand box(size, band), large(2 * size, {0.004, 0.005});
  for (const ProbeShape& probe : {ball, capsule}) {
    PlacedObject plain = object_of(probe), scaled = object_of(probe);
    scaled.placement.scale = 2;
    SceneForce wanted({{}, {plain}, {}}, tick, 0), found({{}, {scaled}, {}}, tick, 0);
    for (int step = 0; step < 200; ++step) {
      const Vector3 point(0.001 + 1e-4 * step, 0.003, 0.048 - 5e-5 * step);
      const ContactForce a = wanted.next(Assets{&large.view}, point);
      const ContactForce b = found.next(Assets{&box.view}, point);
      REQUIRE(a.contact == b.contact);
      // The same map with the same number of samples.
      REQUIRE((a.force - b.force).norm() < 1e-9);
      REQUIRE(a.depth == Approx(b.depth).margin(1e-12));
    }
  }
}

TEST_CASE("A long capsule is felt though its middle is far outside the box of the object's band") {
  const test::BoxByHand box(size, band);
  SceneForce force({{}, {object_of({ProbeKind::capsule, 1e-3, 0.2})}, {}}, tick, 0);
  static_cast<void>(force.next(Assets{&box.view}, {0, 0, 0.5}));
  static_cast<void>(force.next(Assets{&box.view}, {0, 0, 0.13}));
  const ContactForce found = force.next(Assets{&box.view}, {0, 0, 0.12});
  CHECK(found.contact);
  // The end's half ball alone is in the box.
  CHECK(found.depth == Approx(2e-3 / 3).epsilon(0.03));
}

TEST_CASE("Friction, damping and noise of eq. 17 to 19 act on a ball's mean depth") {
  const test::BoxByHand box(size, band);
  PlacedObject object = object_of(ball);
  object.effects.friction_force = 0.2;
  object.effects.friction_depth = 100;
  object.effects.damping = 3;
  SceneForce force({{}, {object}, {}}, tick, 0);
  // The centre is over the box: the ball's lower side touches, the point would not.
  const double height = 0.0205;
  ContactForce found;
  for (int step = 0; step < 4; ++step) {
    found = force.next(Assets{&box.view}, {1e-5 * step, 0, height});
  }
  REQUIRE(found.contact);
  CHECK(found.depth > 1e-4);
  CHECK(found.force.z() == Approx(1000 * found.depth));
  CHECK(found.force.x() == Approx(-0.2 * (1 + 100 * found.depth) - 3 * 0.01).epsilon(1e-6));
  object.effects = {};
  object.effects.texture_noise = 2e-5;
  double sum = 0, squares = 0;
  for (int seed = 0; seed < 4000; ++seed) {
    object.effects.noise_seed = static_cast<std::uint64_t>(seed);
    SceneForce rough({{}, {object}, {}}, tick, 0);
    const ContactForce one = rough.next(Assets{&box.view}, {0, 0, height});
    const double noise = one.force.z() / 1000 - one.depth;
    sum += noise / 4000;
    squares += noise * noise / 4000;
  }
  CHECK(std::abs(sum) < 1.5e-6);
  CHECK(std::sqrt(squares) == Approx(2e-5).epsilon(0.05));
}

}  // namespace
}  // namespace spm::paper_probe_test
