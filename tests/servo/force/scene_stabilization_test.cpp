// SPDX-License-Identifier: Apache-2.0
// What a scene's stabilizers do to its forces.
#include <algorithm>
#include <array>
#include <catch2/catch.hpp>
#include <cmath>
#include <limits>
#include <numbers>
#include <string_view>

#include "servo/force/scene_force.hpp"
#include "tests/support/asset_by_hand.hpp"

namespace spm::scene_stabilization_test {
namespace {

constexpr double size = 0.04;
constexpr double half = size / 2;
constexpr double tick = 1e-3;

using Assets = std::array<const AssetView*, 1>;

ForceScene scene_of_cube(Method method, const StabilizationSettings& stabilization = {}) {
  ForceSettings force;
  force.method = method;
  ForceScene scene = scene_of(force);
  scene.stabilization = stabilization;
  return scene;
}

StabilizationSettings stabilization_of(std::string_view words) {
  StabilizationSettings stabilization;
  REQUIRE(parse_stabilization(words, stabilization));
  return stabilization;
}

/// The hand slides over a side of the cube and its edge, presses and lets go, at a few cm/s.
Vector3 sliding(int at) { return {-0.01 + 4e-5 * at, 0.003, half - 1e-3 * std::sin(0.02 * at)}; }

TEST_CASE("With all stabilizers off a scene gives the forces that it gave, to the bit") {
  const test::SparseCubeByHand cube(size);
  for (const Method method : {Method::spm, Method::proxy}) {
    StabilizationSettings off;
    off.delay_ticks = 3;
    off.device_mass = 7;
    off.coupling_damping = 2;
    ForceScene plain = scene_of_cube(method), stabilized = scene_of_cube(method, off);
    for (ForceScene* scene : {&plain, &stabilized}) {
      scene->objects[0].effects.friction = {0.5, 0.4, 2000};
      scene->objects[0].effects.damping = 2;
      scene->objects[0].effects.turn.rate = default_turn_rate;
    }
    SceneForce wanted(plain, tick, 20e-6), found(stabilized, tick, 20e-6);
    for (int at = 0; at < 900; ++at) {
      CHECK(found.next(Assets{&cube.view}, sliding(at)).force ==
            wanted.next(Assets{&cube.view}, sliding(at)).force);
    }
  }
}

TEST_CASE("Through a coupling a side is as stiff as asked, and no stiffer than it lets through") {
  const test::SparseCubeByHand cube(size);
  for (const Method method : {Method::spm, Method::proxy}) {
    for (const double coupling : {400.0, 1250.0, 1500.0, 4000.0}) {
      StabilizationSettings stabilization;
      stabilization.coupling = coupling;
      SceneForce force(scene_of_cube(method, stabilization), tick, 0);
      for (int at = -5; at < 30; ++at) {
        const double depth = 5e-5 * at;
        const ContactForce found = force.next(Assets{&cube.view}, {0.002, 0.003, half - depth});
        const double felt = std::min(1000.0, max_felt_share * coupling);
        CHECK(found.force.z() == Approx(felt * std::max(depth, 0.0)).margin(2e-3));
        // On the surface rounding decides.
        if (at != 0) CHECK(found.contact == (depth > 0));
      }
    }
  }
}

TEST_CASE("The stiffness that is felt through a coupling is the hand's, whatever the scales") {
  const test::SparseCubeByHand cube(size);
  StabilizationSettings stabilization;
  stabilization.coupling = 1000;
  ForceScene scene = scene_of_cube(Method::spm, stabilization);
  scene.workspace.scale = 2;
  scene.objects[0].placement.scale = 3;
  scene.objects[0].force.stiffness = 1000;  // 2000 of the hand
  SceneForce force(scene, tick, 0);
  const Vector3 world(0.006, 0.009, 3 * half - 1e-3);
  const ContactForce found = force.next(Assets{&cube.view}, scene.workspace.from_world(world));
  CHECK(found.force.z() == Approx(800 * 0.5e-3).epsilon(1e-3));
}

TEST_CASE("A coupling that is stiff enough changes nothing for a force without memory") {
  const test::SparseCubeByHand cube(size);
  StabilizationSettings stabilization;
  stabilization.coupling = 2000;
  SceneForce bare(scene_of_cube(Method::spm), tick, 0);
  SceneForce coupled(scene_of_cube(Method::spm, stabilization), tick, 0);
  // Into an edge, where two sides take turns at holding the hand.
  for (int at = 0; at < 400; ++at) {
    const Vector3 hand(half - 1e-3 + 3e-4 * std::sin(0.9 * at), 0.003, half - 1e-3);
    CHECK(coupled.next(Assets{&cube.view}, hand).force ==
          bare.next(Assets{&cube.view}, hand).force);
  }
}

TEST_CASE("Damping is matched to what is touched, at the hand") {
  const test::SparseCubeByHand cube(size);
  ForceScene scene = scene_of_cube(Method::spm, stabilization_of("damping"));
  scene.objects.push_back(scene.objects[0]);
  scene.objects[1].placement.position = {0.1, 0, 0};
  scene.objects[1].force.stiffness = 500;
  scene.workspace.scale = 2;
  SceneForce force(scene, tick, 0);
  // Two metres of the world for one of the hand, which goes down at 20 mm/s.
  const auto damping = [&](double x, double stiffness) {
    ContactForce found;
    double depth = 0;
    for (int at = 0; at < 40; ++at) {
      depth = 4e-5 * at;
      found = force.next(Assets{&cube.view}, scene.workspace.from_world({x, 0.003, half - depth}));
    }
    return (found.force.z() - stiffness * depth) / 0.02;
  };
  CHECK(damping(0.002, 1000) ==
        Approx(matched_damping(recommended_damping_share, 2000, 1, tick)).epsilon(1e-2));
  force.reset();
  CHECK(damping(0.102, 500) ==
        Approx(matched_damping(recommended_damping_share, 1000, 1, tick)).epsilon(1e-2));
}

TEST_CASE("Of one potential is the force of the lattice, whose turns are not limited") {
  const test::SparseCubeByHand cube(size);
  StabilizationSettings stabilization;
  stabilization.potential = 2e-4;
  for (const double sigma : {0.0, 1e-4}) {
    ForceScene stabilized = scene_of_cube(Method::spm, stabilization);
    stabilized.objects[0].effects.turn.rate = 10;
    stabilized.objects[0].effects.smoothing.sigma = sigma;
    // The object is twice as large for a hand whose metres are half of the world's.
    stabilized.objects[0].placement.scale = 4;
    stabilized.workspace.scale = 2;
    SceneForce found(stabilized, tick, 0);
    PotentialLattice lattice(1e-4);
    ForceSettings force = stabilized.objects[0].force;
    force.stiffness *= 4;
    const RuntimeSmoothing smoothing{sigma / 4};
    int contacts = 0;
    for (int at = 0; at < 900; ++at) {
      const Vector3 local = sliding(at);
      const auto wanted = lattice.force(cube.view, force, smoothing, local);
      const ContactForce felt = found.next(Assets{&cube.view}, 2 * local);
      if (!wanted) continue;
      CHECK((felt.force - wanted->force).norm() < 1e-9);
      contacts += felt.contact ? 1 : 0;
    }
    CHECK(contacts > 300);
  }
}

TEST_CASE("Deeper than its band an object of one potential pushes as hard as any") {
  const test::SparseCubeByHand cube(size);
  StabilizationSettings stabilization;
  stabilization.potential = 1e-4;
  SceneForce force(scene_of_cube(Method::spm, stabilization), tick, 0);
  double last = 0;
  for (int at = 0; at < 400; ++at) {
    const ContactForce found = force.next(Assets{&cube.view}, {0.002, 0.003, half - 1e-5 * at});
    CHECK(found.force.z() >= last - 1e-5);
    last = found.force.z();
  }
  CHECK(last == Approx(2));
}

TEST_CASE("Stabilizers that a running scene is given are those of a scene that began with them") {
  const test::SparseCubeByHand cube(size);
  const StabilizationSettings all = stabilization_of("damping+coupling+passivity+potential");
  SceneForce found(scene_of_cube(Method::spm), tick, 20e-6);
  SceneForce wanted(scene_of_cube(Method::spm, all), tick, 20e-6);
  for (int at = 0; at < 50; ++at) (void)found.next(Assets{&cube.view}, sliding(at));
  for (SceneForce* force : {&found, &wanted}) {
    force->place(0, {0.001, 0, 0}, Eigen::Quaterniond::Identity());
  }
  found.stabilize(all);
  for (int at = 0; at < 300; ++at) {
    CHECK(found.next(Assets{&cube.view}, sliding(at)).force ==
          wanted.next(Assets{&cube.view}, sliding(at)).force);
  }
}

TEST_CASE("A velocity by difference shakes eq. 18's damping by encoder steps, the estimate not") {
  const test::SparseCubeByHand cube(size);
  constexpr double step = 64e-6;
  const auto largest_step = [&](VelocityMethod velocity) {
    StabilizationSettings stabilization;
    stabilization.velocity = velocity;
    ForceScene scene = scene_of_cube(Method::spm, stabilization);
    scene.objects[0].effects.damping = 2;
    SceneForce force(scene, tick, step);
    double largest = 0, last = 0;
    for (int at = 0; at < 300; ++at) {
      // Along the side, at 10 mm/s: the reaction stays.
      const double x = step * std::round(1e-5 * at / step);
      const double along = force.next(Assets{&cube.view}, {x, 0.003, half - 1e-3}).force.x();
      if (at > 100) largest = std::max(largest, std::abs(along - last));
      last = along;
    }
    return largest;
  };
  CHECK(largest_step(VelocityMethod::difference) == Approx(2 * step / tick));
  CHECK(largest_step(VelocityMethod::estimate) < 0.02);
}

TEST_CASE("An object that pushes a yielding hand is not taken for what the loop generates") {
  const test::SparseCubeByHand cube(size);
  SceneForce bare(scene_of_cube(Method::spm), tick, 0);
  SceneForce stabilized(scene_of_cube(Method::spm, stabilization_of("passivity")), tick, 0);
  double largest = 0;
  for (int at = 0; at < 30; ++at) {
    const Vector3 hand(0.002, 0.003, half + 5e-5 * at - 1e-5);
    for (SceneForce* force : {&bare, &stabilized}) {
      force->place(0, {0, 0, 1e-4 * at}, Eigen::Quaterniond::Identity());
    }
    const Vector3 wanted = bare.next(Assets{&cube.view}, hand).force;
    CHECK(wanted.z() > 0);
    largest = std::max(largest, (stabilized.next(Assets{&cube.view}, hand).force - wanted).norm());
  }
  CHECK(largest < 0.01);
}

TEST_CASE("With every stabilizer no position makes a force that is no number") {
  const test::SparseCubeByHand cube(size);
  StabilizationSettings all = stabilization_of("damping+coupling+passivity+potential");
  all.coupling_damping = 1;
  for (const Method method : {Method::spm, Method::proxy}) {
    SceneForce force(scene_of_cube(method, all), tick, 20e-6);
    for (const double bad :
         {std::numeric_limits<double>::quiet_NaN(), std::numeric_limits<double>::infinity(),
          std::numeric_limits<double>::max()}) {
      for (int at = 0; at < 20; ++at) (void)force.next(Assets{&cube.view}, sliding(30 + at));
      CHECK(force.next(Assets{&cube.view}, {bad, 0, half}).force.isZero());
      CHECK(force.next(Assets{&cube.view}, sliding(30)).force.allFinite());
    }
  }
}

}  // namespace
}  // namespace spm::scene_stabilization_test
