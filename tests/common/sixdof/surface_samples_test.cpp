// SPDX-License-Identifier: Apache-2.0
#include "common/sixdof/surface_samples.hpp"

#include <catch2/catch.hpp>
#include <cmath>
#include <utility>
#include <vector>

#include "tests/support/asset_by_hand.hpp"
#include "tests/support/shapes.hpp"

namespace spm::surface_samples_test {
namespace {

using test::BoxByHand;
using test::SparseCubeByHand;

constexpr double size = 0.04;

Vector3 to_vector(const std::array<float, 3>& v) { return {v[0], v[1], v[2]}; }

double area_of(const AssetView& asset, double step) {
  const auto patches = surface_patches(asset, step);
  REQUIRE(patches.has_value());
  double area = 0;
  for (const SurfacePatch& patch : *patches) area += static_cast<double>(patch.area);
  return area;
}

double area_of(const test::Shape& shape) {
  double area = 0;
  for (const auto& [a, b, c] : shape.triangles) {
    const Vector3& at = shape.vertices[a];
    area += (shape.vertices[b] - at).cross(shape.vertices[c] - at).norm() / 2;
  }
  return area;
}

TEST_CASE("The pieces of a cube have its area, and lie on it with its normals") {
  const SparseCubeByHand cube(size);
  for (const double step : {0.01, 0.0021}) {
    CHECK(area_of(cube.view, step) == Approx(6 * size * size).epsilon(1e-5));
  }
  const auto patches = surface_patches(cube.view, 0.003);
  for (const SurfacePatch& patch : *patches) {
    const Vector3 position = to_vector(patch.position), normal = to_vector(patch.normal);
    REQUIRE(position.cwiseAbs().maxCoeff() == Approx(size / 2));
    REQUIRE(position.dot(normal) == Approx(size / 2));
    REQUIRE(static_cast<double>(patch.area) <= 0.003 * 0.003 * 1.0001);
  }
}

TEST_CASE("A surface that would take pieces without bound is refused before they are made") {
  SparseCubeByHand cube(size);
  CHECK(sample_surface(cube.view, size / 100));
  const auto patches = surface_patches(cube.view, 1e-8);
  REQUIRE_FALSE(patches);
  CHECK(patches.error().code == ExitCode::invalid_input);
  CHECK(patches.error().message.find("give a larger spacing") != std::string::npos);
}

TEST_CASE("A box that is no part of the octree has no surface") {
  SparseCubeByHand cube(size);
  cube.view.box_low = Vector3::Constant(1e12);
  cube.view.box_high = Vector3::Constant(2e12);
  const auto samples = sample_surface(cube.view, size / 100);
  REQUIRE_FALSE(samples);
  CHECK(samples.error().code == ExitCode::invalid_input);
}

TEST_CASE("Both sides of a plate are surface, down to few tolerances") {
  SparseCubeByHand cube(size);
  const double thickness = 4 * cube.view.tolerance;
  cube.replace_triangles(test::box({size, size, thickness}));
  CHECK(area_of(cube.view, 0.002) == Approx(2 * size * size + 4 * size * thickness).epsilon(1e-3));
}

TEST_CASE("Pieces of surfaces in any pose have their area") {
  SparseCubeByHand cube(size);
  test::Shape ball = test::sphere(0.4 * size, 3);
  cube.replace_triangles(ball);
  CHECK(area_of(cube.view, 0.001) == Approx(area_of(ball)).epsilon(2e-3));
  test::Shape turned = test::box({0.5 * size, 0.3 * size, 0.4 * size});
  const Eigen::Matrix3d turn = Eigen::AngleAxisd(0.7, Vector3(1, 2, 3).normalized()).matrix();
  for (Vector3& vertex : turned.vertices) vertex = turn * vertex;
  cube.replace_triangles(turned);
  CHECK(area_of(cube.view, 0.0005) == Approx(area_of(turned)).epsilon(5e-3));
}

TEST_CASE("Levels are nested, each with the whole area, and coarser ones bound farther places") {
  const SparseCubeByHand cube(size);
  const auto samples = sample_surface(cube.view, 0.001);
  REQUIRE(samples.has_value());
  REQUIRE(samples->levels.size() > 4);
  CHECK(samples->area == Approx(6 * size * size).epsilon(1e-5));
  CHECK(samples->levels.back().spacing == 0.001);
  CHECK(samples->levels.back().count >= 9600);
  for (std::size_t k = 0; k < samples->levels.size(); ++k) {
    const SampleLevel& level = samples->levels[k];
    double area = 0;
    for (std::uint32_t i = level.first; i < level.first + level.count; ++i) {
      area += static_cast<double>(samples->shares[i].area);
      REQUIRE(samples->shares[i].normal().norm() == Approx(1));
      const SampleChildren below = samples->below(i);
      if (k + 1 == samples->levels.size()) {
        REQUIRE(below.count == 0);
        REQUIRE(samples->places[i].radius == 0);
        continue;
      }
      REQUIRE(below.count > 0);
      REQUIRE(below.first >= samples->levels[k + 1].first);
      REQUIRE(samples->places[below.first].position == samples->places[i].position);
    }
    CHECK(area == Approx(samples->area).epsilon(1e-5));
    if (k > 0) CHECK(level.bound < samples->levels[k - 1].bound);
  }
}

TEST_CASE("A sample's sphere holds all samples below it") {
  const SparseCubeByHand cube(size);
  const auto samples = sample_surface(cube.view, 0.0017);
  REQUIRE(samples.has_value());
  std::vector<std::pair<std::uint32_t, std::uint32_t>> open;
  std::uint32_t finest = 0;
  for (std::uint32_t i = 0; i < samples->levels.back().first; ++i) open.emplace_back(i, i);
  while (!open.empty()) {
    const auto [top, at] = open.back();
    open.pop_back();
    const SampleChildren below = samples->below(at);
    for (std::uint32_t k = 0; k < below.count; ++k) open.emplace_back(top, below.first + k);
    if (below.count > 0) continue;
    ++finest;
    const double off =
        (to_vector(samples->places[at].position) - to_vector(samples->places[top].position)).norm();
    REQUIRE(off <= static_cast<double>(samples->places[top].radius));
  }
  CHECK(finest > samples->levels.back().count);
}

TEST_CASE("The mean place and the spread of a sample are those of its surface") {
  SparseCubeByHand cube(size);
  const auto samples = sample_surface(cube.view, 0.0005);
  REQUIRE(samples.has_value());
  // Each of the coarsest samples stands for one face: it has the face's middle, and the variance of
  // a square, size^2 / 12 per axis.
  REQUIRE(samples->levels[0].count == 6);
  for (std::uint32_t i = 0; i < 6; ++i) {
    const Vector3 middle =
        to_vector(samples->places[i].position) + to_vector(samples->spreads[i].middle);
    CHECK((middle - size / 2 * samples->shares[i].normal()).norm() < 1e-4 * size);
    CHECK(static_cast<double>(samples->spreads[i].spread) == Approx(size / 2).epsilon(1e-3));
  }
}

TEST_CASE("A full asset, an empty one and a spacing of nothing are refused with a cure") {
  const BoxByHand box(Vector3(0.03, 0.03, 0.03));
  const auto full = sample_surface(box.view, 0.001);
  REQUIRE(!full.has_value());
  CHECK(full.error().code == ExitCode::invalid_input);
  CHECK(full.error().message.find("--form sparse") != std::string::npos);
  SparseCubeByHand cube(size);
  for (const double spacing : {0.0, -1.0, 1e-12, std::nan("")}) {
    CHECK(sample_surface(cube.view, spacing).error().code == ExitCode::usage);
  }
  cube.replace_triangles({});
  CHECK(sample_surface(cube.view, 0.001).error().code == ExitCode::invalid_input);
}

}  // namespace
}  // namespace spm::surface_samples_test
