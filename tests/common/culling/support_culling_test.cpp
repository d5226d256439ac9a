// SPDX-License-Identifier: Apache-2.0
#include "common/culling/support_culling.hpp"

#include <algorithm>
#include <catch2/catch.hpp>
#include <cmath>

#include "common/culling/hull_distance.hpp"
#include "common/surface/support_plane_mapping.hpp"
#include "tests/support/asset_by_hand.hpp"
#include "tests/support/random.hpp"

namespace spm::support_culling_test {
namespace {

using Eigen::Isometry3d;
using test::RandomTwister;
using test::SparseCubeByHand;

constexpr double size = 0.04;

SupportHull cube_hull() {
  const SparseCubeByHand cube(size);
  return support_hull(*sample_surface(cube.view, 0.001), 0.0002, 64);
}

Isometry3d pose_of(RandomTwister& random, double most) {
  const Vector3 by = random.vector(most), turn = random.vector(3);
  return Eigen::Translation3d(by) * Isometry3d(Eigen::AngleAxisd(turn.norm(), turn.normalized()));
}

/// Gap between two cubes along the separating axes of faces and edges; 0 or less: they overlap.
double cube_gap(const Isometry3d& pose2) {
  double most = -1;
  const auto along = [&](const Vector3& axis) {
    if (axis.norm() < 1e-9) return;
    const Vector3 v = axis.normalized();
    const double reach =
        size / 2 * (v.cwiseAbs().sum() + (pose2.linear().transpose() * v).cwiseAbs().sum());
    most = std::max(most, std::abs(v.dot(pose2.translation())) - reach);
  };
  for (int i = 0; i < 3; ++i) {
    along(Vector3::Unit(i));
    along(pose2.linear().col(i));
    for (int j = 0; j < 3; ++j) along(Vector3::Unit(i).cross(Vector3(pose2.linear().col(j))));
  }
  return most;
}

TEST_CASE(
    "The distance of a hull is that of a box's nearest corner, edge or face, and 0 around the "
    "origin") {
  RandomTwister random(3);
  for (int trial = 0; trial < 2000; ++trial) {
    const Vector3 middle = random.vector(3);
    std::vector<Vector3> corners;
    for (int k = 0; k < 8; ++k) {
      corners.push_back(
          middle + Vector3((k & 1) != 0 ? 1 : -1, (k & 2) != 0 ? 1 : -1, (k & 4) != 0 ? 1 : -1));
    }
    const double wanted = (middle.cwiseAbs() - Vector3::Ones()).cwiseMax(0).norm();
    const auto support = [&](const Vector3& v) { return corners[support_mapping(corners, v)]; };
    const HullDistance found = hull_distance(support, middle, 1e9, 64);
    REQUIRE(found.lower_bound == Approx(wanted).margin(1e-6));
    REQUIRE(found.direction.norm() == Approx(1));
  }
}

TEST_CASE("A cube's hull needs few of its samples and holds them all within the tolerance") {
  const SparseCubeByHand cube(size);
  const SurfaceSamples samples = *sample_surface(cube.view, 0.001);
  const SupportHull hull = cube_hull();
  CHECK(hull.points.size() < samples.levels.back().count / 20);
  for (const SamplePlace& place : samples.places) {
    const Vector3 at(place.position[0], place.position[1], place.position[2]);
    REQUIRE(in_bounded_space(hull.planes, at, 1e-9));
    const auto support = [&](const Vector3& v) {
      return Vector3(hull.points[support_mapping(hull.points, v)] - at);
    };
    REQUIRE(hull_distance(support, -at, 1, 64).lower_bound <= 0.0002 + 1e-9);
  }
}

TEST_CASE("Cubes that are told apart are, and those that are clearly apart are told so") {
  const SupportHull hull = cube_hull();
  RandomTwister random(5);
  int apart = 0, missed = 0, clear = 0;
  for (int trial = 0; trial < 5000; ++trial) {
    const Isometry3d pose = pose_of(random, 0.05);
    const double truth = cube_gap(pose);
    SeparatingDirection none;
    const CullResult result = objects_apart(hull, hull, pose, none);
    if (result.apart) {
      ++apart;
      REQUIRE(truth > 0);
    } else if (truth > 2.5 * hull.grown) {
      ++missed;
    }
    clear += truth > 2.5 * hull.grown ? 1 : 0;
  }
  CHECK(apart > 1000);
  CHECK(missed <= clear / 200);
}

TEST_CASE("The direction that separated a pair tells it apart again where it moves little") {
  const SupportHull hull = cube_hull();
  RandomTwister random(7);
  SeparatingDirection last;
  Isometry3d pose = Eigen::Translation3d(0.045, 0.02, 0.01) *
                    Isometry3d(Eigen::AngleAxisd(0.1, Vector3::UnitZ()));
  REQUIRE(objects_apart(hull, hull, pose, last).apart);
  int remembered = 0;
  for (int tick = 0; tick < 200; ++tick) {
    pose.pretranslate(random.vector(5e-5));
    remembered += objects_apart(hull, hull, pose, last).stage == CullStage::remembered ? 1 : 0;
  }
  CHECK(remembered > 195);
}

TEST_CASE("What is far is told by balls alone, and what is no pose is told nothing") {
  const SupportHull hull = cube_hull();
  SeparatingDirection last;
  const CullResult far =
      objects_apart(hull, hull, Isometry3d(Eigen::Translation3d(0.2, 0, 0)), last);
  CHECK(far.apart);
  CHECK(far.stage == CullStage::ball);
  CHECK(far.lower_bound > 0.12);
  CHECK_FALSE(objects_apart(hull, hull, Isometry3d(Eigen::Translation3d(NAN, 0, 0)), last).apart);
  CHECK_FALSE(objects_apart(hull, {}, Isometry3d(Eigen::Translation3d(1, 0, 0)), last).apart);
}

}  // namespace
}  // namespace spm::support_culling_test
