// SPDX-License-Identifier: Apache-2.0
#include "common/culling/support_culling.hpp"

#include <algorithm>
#include <catch2/catch.hpp>
#include <cmath>

#include "common/base/spread_direction.hpp"
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

/// A cube of which copies are culled: its samples, and as many planes as a bake has at most.
struct CulledCube {
  SparseCubeByHand cube{size};
  SurfaceSamples samples = *sample_surface(cube.view, 0.001);
  SupportHull hull = support_hull(samples);
  std::vector<SupportPlane> planes = planes_about_cube();
  SupportedObject object{Vector3::Constant(-size / 2), Vector3::Constant(size / 2), planes};

  static std::vector<SupportPlane> planes_about_cube() {
    std::vector<Vector3> corners;
    corners.reserve(8);
    for (int k = 0; k < 8; ++k) {
      corners.push_back(
          size / 2 * Vector3((k & 1) != 0 ? 1 : -1, (k & 2) != 0 ? 1 : -1, (k & 4) != 0 ? 1 : -1));
    }
    std::vector<SupportPlane> planes;
    planes.reserve(42);
    for (std::size_t k = 0; k < 42; ++k) {
      planes.push_back(vertex_support_plane(corners, spread_direction(k, 42)));
    }
    return planes;
  }
};

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
    corners.reserve(8);
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

TEST_CASE("No sample reaches below what the hull says, from any side") {
  const CulledCube made;
  CHECK(made.hull.points.size() < made.samples.levels.back().count / 20);
  RandomTwister random(3);
  for (int trial = 0; trial < 500; ++trial) {
    const Vector3 normal = random.vector(1).normalized();
    double least = 1;
    for (const SamplePlace& place : made.samples.places) {
      least = std::min(
          least, normal.dot(Vector3(place.position[0], place.position[1], place.position[2])));
    }
    REQUIRE(made.hull.lowest(normal) <= least + 1e-9);
    REQUIRE(made.hull.lowest(normal) > least - 2 * made.hull.grown);
  }
}

TEST_CASE("Cubes that are told apart are, and half of those that are clearly apart are told so") {
  const CulledCube made;
  RandomTwister random(5);
  int apart = 0, missed = 0, clear = 0;
  for (int trial = 0; trial < 5000; ++trial) {
    const Isometry3d pose = pose_of(random, 0.05);
    const double truth = cube_gap(pose), reach = random.between(0, 0.005);
    std::uint32_t none = no_plane;
    const bool told = objects_apart(made.object, made.hull, pose, reach, none) != CullStage::none;
    if (told) {
      ++apart;
      REQUIRE(truth > reach);
    }
    if (truth > reach + 0.002) {
      ++clear;
      missed += told ? 0 : 1;
    }
  }
  CHECK(apart > 400);
  CHECK(missed <= clear / 2);
}

TEST_CASE("The plane most parallel to the way between two objects separates them first") {
  const CulledCube made;
  std::uint32_t last = no_plane;
  const Vector3 way = Vector3(0.2, 1, 0.1).normalized();
  const Isometry3d pose(Eigen::Translation3d(0.005, 0.05, 0.002));
  REQUIRE(objects_apart(made.object, made.hull, pose, 0, last) == CullStage::plane);
  const Vector3 from_box(0, pose.translation().y() - size / 2, 0);
  CHECK(last == support_plane_mapping(made.planes, from_box));
  CHECK(made.planes[last].n.dot(way) > 0.8);
}

TEST_CASE("The plane that separated a pair tells it apart again where it moves little") {
  const CulledCube made;
  RandomTwister random(7);
  std::uint32_t last = no_plane;
  Isometry3d pose =
      Eigen::Translation3d(0.05, 0.02, 0.01) * Isometry3d(Eigen::AngleAxisd(0.1, Vector3::UnitZ()));
  REQUIRE(objects_apart(made.object, made.hull, pose, 0, last) == CullStage::plane);
  int remembered = 0;
  for (int tick = 0; tick < 200; ++tick) {
    pose.pretranslate(random.vector(5e-5));
    const CullStage stage = objects_apart(made.object, made.hull, pose, 0, last);
    remembered += stage == CullStage::remembered ? 1 : 0;
  }
  CHECK(remembered > 195);
}

TEST_CASE("A scaled object is culled at its own size") {
  const CulledCube made;
  SupportedObject twice = made.object;
  twice.scale = 2;
  std::uint32_t none = no_plane;
  const Isometry3d pose(Eigen::Translation3d(0.052, 0, 0));
  CHECK(objects_apart(made.object, made.hull, pose, 0, none) == CullStage::plane);
  CHECK(objects_apart(twice, made.hull, pose, 0, none) == CullStage::none);
}

TEST_CASE("What is far is told by box and ball alone, and what is no pose is told nothing") {
  const CulledCube made;
  std::uint32_t last = no_plane;
  const auto at = [&](double x, const SupportedObject& object) {
    return objects_apart(object, made.hull, Isometry3d(Eigen::Translation3d(x, 0, 0)), 0, last);
  };
  CHECK(at(0.2, made.object) == CullStage::box);
  CHECK(last == no_plane);
  CHECK(at(NAN, made.object) == CullStage::none);
  SupportedObject bare = made.object;
  bare.planes = {};
  CHECK(at(0.052, bare) == CullStage::none);
}

}  // namespace
}  // namespace spm::support_culling_test
