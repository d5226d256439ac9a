// SPDX-License-Identifier: GPL-3.0-or-later
#include <array>
#include <catch2/catch.hpp>
#include <cmath>
#include <numbers>

#include "common/sixdof/object_contact.hpp"
#include "tests/baker/pipeline/bake_support.hpp"
#include "tests/support/asset_by_hand.hpp"
#include "tests/support/random.hpp"

namespace spm::baker::object_quadrature_baked_test {
namespace {

using Eigen::Isometry3d;

constexpr double ball_radius = 0.015, face_size = 0.012;

/// Of a flat face on a ball, the integral of the depth's upward part: pi h (R - h)^2, where the
/// face is h above the middle.
double wanted_force(double depth) {
  const double height = ball_radius - depth;
  return 1e9 * std::numbers::pi * height * depth * depth;
}

TEST_CASE("Coarse patches count how the field bends over them") {
  BakeOptions options;
  options.tolerance = 20e-6;
  const BakeResult baked = bake(test::mesh_of(test::sphere(ball_radius, 5)), options);
  const AssetTables tables = tables_of(baked.asset);
  const test::SparseCubeByHand cube(face_size);
  const SurfaceSamples samples = *sample_surface(cube.view, 0.0002);
  const std::array objects{ContactObject{&tables.view(), Isometry3d::Identity()}};
  ObjectContactSettings settings;
  settings.stiffness = 1e9;
  ObjectContact contact(samples, settings);
  test::RandomTwister random(11);
  TickBudget budget;
  budget.accuracy = 1e-9;
  // Patches of 1.6 mm, on a contact that is some 7 mm wide.
  budget.finest_level = static_cast<std::uint32_t>(samples.levels.size()) - 4;
  double errors = 0;
  constexpr int tries = 100;
  for (int i = 0; i < tries; ++i) {
    const double depth = random.between(3e-4, 6e-4);
    const Isometry3d pose(Eigen::Translation3d(random.between(-1e-3, 1e-3),
                                               random.between(-1e-3, 1e-3),
                                               ball_radius + face_size / 2 - depth));
    const Vector3 force = contact.tick(pose, objects, budget).sum.forces().force;
    const double error = force.z() / wanted_force(depth) - 1;
    errors += error * error;
  }
  INFO("error " << std::sqrt(errors / tries));
  CHECK(std::sqrt(errors / tries) < 0.04);
}

}  // namespace
}  // namespace spm::baker::object_quadrature_baked_test
