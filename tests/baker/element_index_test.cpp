// SPDX-License-Identifier: GPL-3.0-or-later
#include <catch2/catch.hpp>
#include <cmath>

#include "bake_support.hpp"
#include "baker/random.hpp"
#include "common/query.hpp"

namespace spm::baker {
namespace {

/// A random place of the box around an asset's band.
Vector3 place(const Extent& extent, std::uint64_t seed, std::uint64_t number) {
  Vector3 share;
  for (int axis = 0; axis < 3; ++axis) {
    share[axis] = random_unit(seed, 3 * number + static_cast<std::uint64_t>(axis));
  }
  return extent.low + share.cwiseProduct(extent.size);
}

/// Asks at random places by the index, which must tell at a share of them, and by descending the
/// tree.
void check_alike(const test::Shape& shape, double tolerance, double least_listed) {
  BakeOptions options;
  options.tolerance = tolerance;
  const BakeResult result = bake(test::mesh_of(shape), options);
  AssetTables tables = tables_of(result.asset);
  const AssetView by_tree = tables.view();
  tables.build_index();
  const AssetView& by_index = tables.view();
  REQUIRE(!by_index.index.words.empty());
  const Extent extent = extent_of(by_tree);
  std::size_t exact = 0, listed = 0, far_feet = 0, other_normals = 0;
  for (std::uint64_t seed = 1; seed <= 3; ++seed) {
    for (std::uint64_t i = 0; i < 20000; ++i) {
      const Vector3 point = place(extent, seed, i);
      const Answer wanted = query_point(by_tree, point), found = query_point(by_index, point);
      REQUIRE(found.status == wanted.status);
      if (wanted.status != Status::exact) continue;
      ++exact;
      const IndexList list = list_at(by_index.index, point);
      listed += list.numbers != nullptr ? 1 : 0;
      // On the surface itself either side may be told.
      if (std::abs(wanted.distance) > tolerance / 4) {
        REQUIRE((found.distance < 0) == (wanted.distance < 0));
      }
      // The foot on a cell is a near one, and which is found may hang on what was found before.
      REQUIRE(found.distance == Approx(wanted.distance).margin(tolerance / 4));
      far_feet += std::abs(found.distance - wanted.distance) > 1e-8 ? 1 : 0;
      other_normals += (found.normal - wanted.normal).norm() > 1e-4 ? 1 : 0;
    }
  }
  CHECK(exact > 2000);
  CHECK(static_cast<double>(listed) > least_listed * static_cast<double>(exact));
  CHECK(far_feet * 100 <= exact);
  // By the tree one foot of a tile is looked at, by the index one of each cell: at a kink between
  // cells another may be found that faces the point.
  CHECK(other_normals * 40 <= exact);
}

TEST_CASE("On a torus of many tiles the index answers as the tree does") {
  check_alike(test::torus(0.03, 0.012, 96, 48), 50e-6, 0.9);
}

TEST_CASE("On a box of few tiles and on triangles alone the index answers as the tree does") {
  check_alike(test::box({0.03, 0.04, 0.02}), 100e-6, 0.9);
  // Thousands of triangles are alike near in its middle: the index gives up, and the tree tells.
  check_alike(test::sphere(0.004, 1), 1e-6, 0.01);
}

TEST_CASE("An asset of the full form has no index") {
  BakeOptions options;
  options.form = AssetForm::full;
  options.planes = 6;
  options.resolution = 9;
  const BakeResult result = bake(test::mesh_of(test::box({0.03, 0.04, 0.02})), options);
  AssetTables tables = tables_of(result.asset);
  tables.build_index();
  CHECK(tables.view().index.words.empty());
}

}  // namespace
}  // namespace spm::baker
