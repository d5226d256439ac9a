// SPDX-License-Identifier: GPL-3.0-or-later
#include <catch2/catch.hpp>
#include <cmath>
#include <numbers>
#include <utility>

#include "common/sixdof/surface_samples.hpp"
#include "tests/baker/pipeline/bake_support.hpp"

namespace spm::baker::surface_samples_baked_test {
namespace {

SurfaceSamples samples_of(const AssetView& view, double spacing) {
  auto samples = sample_surface(view, spacing);
  REQUIRE(samples.has_value());
  return std::move(*samples);
}

Vector3 to_vector(const std::array<float, 3>& v) { return {v[0], v[1], v[2]}; }

TEST_CASE("Samples of a baked ball have its area, and lie on it with its normals") {
  constexpr double radius = 0.029, tolerance = 20e-6;
  BakeOptions options;
  options.tolerance = tolerance;
  const BakeResult baked = bake(test::mesh_of(test::sphere(radius, 5)), options);
  const AssetTables tables = tables_of(baked.asset);
  for (const double spacing : {0.004, 0.001}) {
    const SurfaceSamples samples = samples_of(tables.view(), spacing);
    CHECK(samples.area == Approx(4 * std::numbers::pi * radius * radius).epsilon(5e-3));
    const SampleLevel& finest = samples.levels.back();
    for (std::uint32_t i = finest.first; i < finest.first + finest.count; ++i) {
      const Vector3 position = to_vector(samples.places[i].position);
      REQUIRE(std::abs(position.norm() - radius) < 2 * tolerance + 20e-6);  // facets: 15 um
      REQUIRE(samples.shares[i].normal().dot(position) > 0.98 * radius);
    }
  }
}

TEST_CASE("Samples of two balls that overlap have the area of their union") {
  constexpr double radius = 0.02, apart = 0.024;
  const test::Shape both = test::merged(test::moved(test::sphere(radius, 5), {-apart / 2, 0, 0}),
                                        test::moved(test::sphere(radius, 5), {apart / 2, 0, 0}));
  const BakeResult baked = bake(test::mesh_of(both), {});
  const AssetTables tables = tables_of(baked.asset);
  // Each ball lacks a cap as high as half of their overlap.
  const double wanted = 2 * (4 * std::numbers::pi * radius * radius -
                             2 * std::numbers::pi * radius * (radius - apart / 2));
  CHECK(samples_of(tables.view(), 0.002).area == Approx(wanted).epsilon(1e-2));
}

TEST_CASE("Samples of a box have its area for coarse and fine bakes, whatever their elements") {
  const Vector3 size(0.03, 0.02, 0.04);
  for (const double tolerance : {20e-6, 300e-6}) {
    BakeOptions options;
    options.tolerance = tolerance;
    const BakeResult baked = bake(test::mesh_of(test::box(size)), options);
    const AssetTables tables = tables_of(baked.asset);
    const SurfaceSamples samples = samples_of(tables.view(), 0.0007);
    CHECK(samples.area == Approx(2 * (0.03 * 0.02 + 0.02 * 0.04 + 0.04 * 0.03)).epsilon(5e-3));
  }
}

}  // namespace
}  // namespace spm::baker::surface_samples_baked_test
