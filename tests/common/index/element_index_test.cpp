// SPDX-License-Identifier: GPL-3.0-or-later
#include <catch2/catch.hpp>
#include <cmath>
#include <vector>

#include "common/base/random.hpp"
#include "common/query/closest_element.hpp"
#include "common/query/query.hpp"
#include "tests/baker/pipeline/bake_support.hpp"

namespace spm::baker::element_index_test {
namespace {

/// A random place in the box around an asset's band.
Vector3 place(const Extent& extent, std::uint64_t seed, std::uint64_t number) {
  Vector3 share;
  for (int axis = 0; axis < 3; ++axis) {
    share[axis] = random_unit(seed, 3 * number + static_cast<std::uint64_t>(axis));
  }
  return extent.low + share.cwiseProduct(extent.size);
}

/// Checks what needs no list: a far cube gives a lower bound of the distance, and a point deeper
/// than the band gets a unit normal.
void check_beyond(const AssetView& by_tree, const IndexList& list, const Answer& answer,
                  const Vector3& point) {
  if (list.kind == CubeKind::far) {
    REQUIRE(list.numbers == nullptr);
    const double distance = read_elements(by_tree, point, CubeKind::boundary).nearest.distance;
    REQUIRE(distance >= static_cast<double>(list.beyond));
  }
  if (answer.status == Status::deep) REQUIRE(answer.normal.norm() == Approx(1));
}

/// Querying all points at once must give the same answers as querying them one by one.
void check_at_once(const AssetView& asset, const std::vector<Vector3>& points,
                   const std::vector<Answer>& wanted) {
  Answer other;
  other.plane = other.layer = 7;
  std::vector<Answer> answers(points.size(), other);
  query_points(asset, points, answers);
  for (std::size_t i = 0; i < points.size(); ++i) {
    REQUIRE(answers[i].status == wanted[i].status);
    REQUIRE(answers[i].normal == wanted[i].normal);
    REQUIRE(answers[i].plane == wanted[i].plane);
    REQUIRE(answers[i].layer == wanted[i].layer);
    REQUIRE(answers[i].source == wanted[i].source);
    if (std::isnan(wanted[i].distance)) continue;
    REQUIRE(answers[i].distance == wanted[i].distance);
  }
}

/// Queries random places with the index, which must have lists for a share of them, and by
/// descending the tree. Both must agree.
void check_alike(const test::Shape& shape, double tolerance, double min_listed) {
  BakeOptions options;
  options.tolerance = tolerance;
  const BakeResult result = bake(test::mesh_of(shape), options);
  AssetTables tables = tables_of(result.asset);
  const AssetView by_tree = tables.view();
  tables.build_index();
  const AssetView& by_index = tables.view();
  REQUIRE(!by_index.index.words.empty());
  const Extent extent = extent_of(by_tree);
  std::size_t exact = 0, listed = 0, far = 0, far_closest_points = 0, other_normals = 0;
  std::vector<Vector3> points{{0, 0, std::nan("")}, extent.low - Vector3::Ones()};
  std::vector<Answer> answers{query_point(by_index, points[0]), query_point(by_index, points[1])};
  for (std::uint64_t seed = 1; seed <= 3; ++seed) {
    for (std::uint64_t i = 0; i < 20000; ++i) {
      const Vector3 point = place(extent, seed, i);
      const Answer wanted = query_point(by_tree, point), found = query_point(by_index, point);
      points.push_back(point);
      answers.push_back(found);
      REQUIRE(found.status == wanted.status);
      const IndexList list = list_at(by_index.index, point);
      far += list.kind == CubeKind::far ? 1 : 0;
      if (i % 16 == 0) check_beyond(by_tree, list, found, point);
      if (wanted.status != Status::exact) continue;
      ++exact;
      listed += list.numbers != nullptr ? 1 : 0;
      // On the surface itself the answer may be either side.
      if (std::abs(wanted.distance) > tolerance / 4) {
        REQUIRE((found.distance < 0) == (wanted.distance < 0));
      }
      // The closest point on a cell is approximate: which point is found may depend on what was
      // found before.
      REQUIRE(found.distance == Approx(wanted.distance).margin(tolerance / 4));
      far_closest_points += std::abs(found.distance - wanted.distance) > 1e-8 ? 1 : 0;
      other_normals += (found.normal - wanted.normal).norm() > 1e-4 ? 1 : 0;
    }
  }
  CHECK(exact > 2000);
  CHECK(far > 200);
  check_at_once(by_index, points, answers);
  CHECK(static_cast<double>(listed) > min_listed * static_cast<double>(exact));
  CHECK(far_closest_points * 100 <= exact);
  // The tree looks at one closest point per tile, the index at one per cell. At a kink between
  // cells the index may find another closest point that faces the query point.
  CHECK(other_normals * 40 <= exact);
}

TEST_CASE("On a torus of many tiles the index answers as the tree does") {
  check_alike(test::torus(0.03, 0.012, 96, 48), 50e-6, 0.9);
}

TEST_CASE("On a box of few tiles the index answers as the tree does") {
  check_alike(test::box({0.03, 0.04, 0.02}), 100e-6, 0.9);
}

TEST_CASE("On triangles alone the index answers as the tree does") {
  // Thousands of triangles are equally near in its middle: the index gives up, the tree answers.
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
}  // namespace spm::baker::element_index_test
