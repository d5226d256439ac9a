// SPDX-License-Identifier: GPL-3.0-or-later
#include <catch2/catch.hpp>
#include <cmath>
#include <numbers>
#include <vector>

#include "common/sixdof/overlap_volume.hpp"
#include "tests/baker/pipeline/bake_support.hpp"

namespace spm::baker::overlap_volume_baked_test {
namespace {

using Eigen::Isometry3d;
constexpr double pi = std::numbers::pi;
const Vector3 box_size(0.03, 0.04, 0.02);
constexpr double ball_radius = 0.015;

/// A shape with its asset and samples.
struct Body {
  explicit Body(const test::Shape& shape, double spacing = 0.0005)
      : baked(bake(test::mesh_of(shape), options())),
        tables(tables_of(baked.asset)),
        samples(*sample_surface(tables.view(), spacing)) {}
  static BakeOptions options() {
    BakeOptions made;
    made.tolerance = 20e-6;
    return made;
  }
  [[nodiscard]] SampledObject object() const { return {&tables.view(), &samples}; }
  BakeResult baked;
  AssetTables tables;
  SurfaceSamples samples;
};

const Body& box_body() {
  static const Body body(test::box(box_size));
  return body;
}
const Body& ball_body() {
  static const Body body(test::sphere(ball_radius, 5));
  return body;
}

/// Volume of a cap of a ball.
double cap(double radius, double height) { return pi * height * height * (radius - height / 3); }

using Polygon = std::vector<Vector3>;

/// The faces of a box, seen from outside, moved.
std::vector<Polygon> faces(const Vector3& size, const Isometry3d& pose) {
  std::vector<Polygon> made;
  for (int axis = 0; axis < 3; ++axis) {
    for (const double side : {0.5, -0.5}) {
      const Vector3 middle = side * size[axis] * Vector3::Unit(axis);
      const Vector3 u =
          size[(axis + 1) % 3] / 2 * Vector3::Unit((axis + 1) % 3) * (side > 0 ? 1 : -1);
      const Vector3 v = size[(axis + 2) % 3] / 2 * Vector3::Unit((axis + 2) % 3);
      made.push_back({pose * Vector3(middle - u - v), pose * Vector3(middle + u - v),
                      pose * Vector3(middle + u + v), pose * Vector3(middle - u + v)});
    }
  }
  return made;
}

/// The part of a polygon that lies in a box about the origin.
Polygon cut_to_box(Polygon polygon, const Vector3& size) {
  for (int axis = 0; axis < 3; ++axis) {
    for (const double side : {1.0, -1.0}) {
      Polygon kept;
      for (std::size_t i = 0; i < polygon.size(); ++i) {
        const Vector3 &a = polygon[i], &b = polygon[(i + 1) % polygon.size()];
        const double from = size[axis] / 2 - side * a[axis], to = size[axis] / 2 - side * b[axis];
        if (from >= 0) kept.push_back(a);
        if ((from < 0) != (to < 0)) kept.push_back(a + from / (from - to) * (b - a));
      }
      polygon = kept;
    }
  }
  return polygon;
}

struct Solid {
  double volume = 0;
  Vector3 centre = Vector3::Zero();
};

/// The overlap of a box about the origin with another, moved box, by their polygons.
Solid boxes_overlap(const Vector3& size1, const Vector3& size2, const Isometry3d& pose2) {
  std::vector<Polygon> boundary;
  for (const Polygon& face : faces(size2, pose2)) boundary.push_back(cut_to_box(face, size1));
  for (const Polygon& face : faces(size1, pose2.inverse())) {
    boundary.push_back(cut_to_box(face, size2));
    for (Vector3& corner : boundary.back()) corner = pose2 * corner;
  }
  Solid solid;
  for (const Polygon& face : boundary) {
    for (std::size_t i = 2; i < face.size(); ++i) {
      const double cone = face[0].dot(face[i - 1].cross(face[i])) / 6;
      solid.volume += cone;
      solid.centre += cone * (face[0] + face[i - 1] + face[i]) / 4;
    }
  }
  solid.centre /= solid.volume;
  return solid;
}

Isometry3d at(double x, double y, double z) { return Isometry3d(Eigen::Translation3d(x, y, z)); }

TEST_CASE("Two balls share a lens: volume, middle and push are those of its closed form") {
  for (const double depth : {0.001, 0.004, 0.01}) {
    const double apart = 2 * ball_radius - depth;
    const Vector3 along = Vector3(1, 2, -0.5).normalized();
    const OverlapVolume overlap =
        overlap_volume(ball_body().object(), ball_body().object(),
                       Eigen::Translation3d(apart * along) * Isometry3d::Identity());
    const double rim = ball_radius * ball_radius - apart * apart / 4;
    CHECK(overlap.volume == Approx(2 * cap(ball_radius, depth / 2)).epsilon(0.02));
    CHECK((overlap.centre - apart / 2 * along).norm() < 0.02 * depth + 2e-5);
    CHECK((overlap.push - pi * rim * along).norm() < 0.02 * pi * rim);
  }
}

TEST_CASE("A ball in a face of a box shares a cap") {
  for (const double depth : {0.002, 0.006}) {
    const OverlapVolume overlap =
        overlap_volume(box_body().object(), ball_body().object(),
                       at(0, 0.003, box_size.z() / 2 + ball_radius - depth));
    CHECK(overlap.volume == Approx(cap(ball_radius, depth)).epsilon(0.01));
    CHECK(overlap.push.normalized().z() > 0.9999);
  }
}

TEST_CASE("Two boxes share what their polygons say, however they are tilted") {
  const Vector3 axis = Vector3(1, 0.4, 0.2).normalized();
  for (const double degrees : {0.0, 10.0, 30.0, 45.0, 70.0}) {
    const Isometry3d pose = at(0.006, 0.008, 0.017) * Eigen::AngleAxisd(degrees * pi / 180, axis);
    const Solid wanted = boxes_overlap(box_size, box_size, pose);
    REQUIRE(wanted.volume > 1e-7);
    const OverlapVolume overlap = overlap_volume(box_body().object(), box_body().object(), pose);
    INFO(degrees << " degrees");
    CHECK(overlap.volume == Approx(wanted.volume).epsilon(0.005));
    CHECK((overlap.centre - wanted.centre).norm() < 5e-5);
  }
}

TEST_CASE("A box that dips an edge into a slab shares a wedge") {
  const Vector3 slab(0.06, 0.06, 0.02), bar(0.02, 0.02, 0.02);
  const Body slab_body(test::box(slab)), bar_body(test::box(bar));
  constexpr double depth = 0.004;
  for (const double degrees : {30.0, 45.0}) {
    const double angle = degrees * pi / 180;
    const double lowest = bar.y() / 2 * (std::sin(angle) + std::cos(angle));
    const Isometry3d pose =
        at(0, 0, slab.z() / 2 + lowest - depth) * Eigen::AngleAxisd(angle, Vector3::UnitX());
    const double wedge = depth * depth / 2 * bar.x() / (std::sin(angle) * std::cos(angle));
    CHECK(overlap_volume(slab_body.object(), bar_body.object(), pose).volume ==
          Approx(wedge).epsilon(0.01));
  }
}

}  // namespace
}  // namespace spm::baker::overlap_volume_baked_test
