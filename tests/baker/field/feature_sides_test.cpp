// SPDX-License-Identifier: GPL-3.0-or-later
#include "baker/field/feature_sides.hpp"

#include <algorithm>
#include <array>
#include <catch2/catch.hpp>
#include <optional>
#include <vector>

#include "baker/cast/cast.hpp"
#include "common/base/random.hpp"
#include "tests/baker/pipeline/bake_support.hpp"
#include "tests/support/shapes.hpp"

namespace spm::baker::feature_sides_test {
namespace {

std::vector<FeatureSides> sides_of(const OuterSurface& surface, double tolerance = 1e-4,
                                   double displacement = 0, double thin = 0) {
  const Caster caster(surface);
  return find_feature_sides(surface, {caster, caster, tolerance, displacement, thin});
}

/// The side of a place by the nearest triangle alone, as the file tells it.
std::optional<bool> told_inside(const OuterSurface& surface, const std::vector<FeatureSides>& sides,
                                const Vector3& point) {
  double least = 1;
  std::optional<bool> inside;
  for (std::size_t t = 0; t < surface.triangles.size(); ++t) {
    const Vector3 &a = surface.vertices[surface.triangles[t][0]],
                  &b = surface.vertices[surface.triangles[t][1]],
                  &c = surface.vertices[surface.triangles[t][2]];
    const ClosestFeature closest = closest_feature(point, a, b, c);
    const double distance = (point - closest.point).norm();
    if (distance >= least) continue;
    least = distance;
    const double along = along_normal((b - a).cross(c - a), point - closest.point);
    inside = side_told(sides[t], closest.feature, along);
  }
  return inside;
}

/// No triangle of a corner says of a place outside beside it that it is inside.
void check_outside(const OuterSurface& surface, const std::vector<FeatureSides>& sides,
                   std::uint32_t vertex, const Vector3& place) {
  for (std::size_t t = 0; t < surface.triangles.size(); ++t) {
    const Triangle& triangle = surface.triangles[t];
    const auto at = std::find(triangle.begin(), triangle.end(), vertex);
    if (at == triangle.end()) continue;
    const Vector3 &a = surface.vertices[triangle[0]], &b = surface.vertices[triangle[1]],
                  &c = surface.vertices[triangle[2]];
    const auto corner = static_cast<TriangleFeature>(4 + (at - triangle.begin()));
    INFO("triangle " << t);
    const double along = along_normal((b - a).cross(c - a), place - surface.vertices[vertex]);
    CHECK_FALSE(side_told(sides[t], corner, along).value_or(false));
  }
}

/// A deck, seen from above its edge along x, that dips a little at the corner 0. Below it the side
/// of the solid steps back there by a wall that overhangs. No place is nearest to that corner
/// alone, but above it the deck's edge is nearer by no more than single precision tells.
OuterSurface dipped_deck() {
  OuterSurface surface;
  surface.vertices = {{0, 0, 0},  {-5, 0, 0.0075}, {5, 0, 0.0075},  {5, 5, 0},
                      {-5, 5, 0}, {-5, -1, -1},    {-0.04, -1, -1}, {-0.04, 0, -1},
                      {5, 0, -1}, {5, 5, -1},      {-5, 5, -1}};
  for (Vector3& vertex : surface.vertices) vertex *= 0.001;
  surface.triangles = {{0, 2, 3},  {0, 3, 4},  {0, 4, 1},  {1, 5, 0}, {5, 6, 0},  {0, 6, 7},
                       {0, 7, 8},  {0, 8, 2},  {2, 8, 3},  {8, 9, 3}, {3, 9, 4},  {9, 10, 4},
                       {4, 10, 1}, {10, 5, 1}, {5, 10, 7}, {5, 7, 6}, {10, 9, 7}, {9, 8, 7}};
  surface.solid_count = surface.triangles.size();
  return surface;
}

/// A prism along x with an L for its section, whose inner edge ends at the origin. The first
/// triangles, so many, are a fan of one of the walls around the origin.
OuterSurface notched_prism(std::uint32_t fan) {
  OuterSurface surface;
  const std::vector<std::array<double, 2>> section{{0, 0},  {-1, 0}, {-1, -1},
                                                   {1, -1}, {1, 1},  {0, 1}};
  const std::uint32_t count = 6, far = 3, behind = 6;
  for (const double x : {0.0, -1.0}) {
    for (const auto& [y, z] : section) surface.vertices.emplace_back(x, y, z);
  }
  std::vector<std::uint32_t> cut{behind};
  for (std::uint32_t i = 1; i < fan; ++i) {
    cut.push_back(static_cast<std::uint32_t>(surface.vertices.size()));
    surface.vertices.emplace_back(-1, 0, static_cast<double>(i) / fan);
  }
  cut.push_back(behind + count - 1);
  for (Vector3& vertex : surface.vertices) vertex *= 0.03;
  for (std::size_t i = 0; i + 1 < cut.size(); ++i) {
    surface.triangles.push_back({0, cut[i + 1], cut[i]});
    surface.triangles.push_back({behind + far, cut[i], cut[i + 1]});
  }
  std::stable_partition(surface.triangles.begin(), surface.triangles.end(),
                        [](const Triangle& triangle) { return triangle[0] == 0; });
  surface.triangles.push_back({0, count - 1, behind + count - 1});
  for (std::uint32_t i = 0; i + 1 < count; ++i) {
    const std::uint32_t next = i + 1;
    surface.triangles.push_back({i, behind + i, next});
    surface.triangles.push_back({next, behind + i, behind + next});
    if (i == far || next == far) continue;
    surface.triangles.push_back({far, i, next});
    surface.triangles.push_back({behind + far, behind + next, behind + i});
  }
  surface.triangles.push_back({far, count - 1, 0});
  surface.solid_count = surface.triangles.size();
  return surface;
}

}  // namespace

TEST_CASE("A face below another sheet, which displacement might hide, tells no wrong side") {
  // Two boxes, the upper one 45 um above the lower one. What is 400 um above the lower one lies in
  // the upper one, whose lower face is nearer by less than the displacement.
  OuterSurface surface;
  for (const double z : {-0.002, 0.000045}) {
    const test::Shape box = test::box({0.01, 0.01, 0.002});
    const auto first = static_cast<std::uint32_t>(surface.vertices.size());
    for (const Vector3& vertex : box.vertices) {
      surface.vertices.push_back(vertex + Vector3(0, 0, z + 0.001));
    }
    for (const auto& [a, b, c] : box.triangles) {
      surface.triangles.push_back({a + first, b + first, c + first});
    }
  }
  surface.solid_count = surface.triangles.size();
  const std::vector<FeatureSides> sides = sides_of(surface, 4e-4, 5.6e-5);
  for (const double z : {-0.00002, 0.00002, 0.000025}) {
    CHECK(told_inside(surface, sides, {0.0003, 0.0004, z}).value_or(z < 0) == (z < 0));
  }
}

TEST_CASE("A corner that nothing is nearest to tells the side of places that rounding gives it") {
  const OuterSurface surface = dipped_deck();
  const Caster caster(surface);
  const std::vector<FeatureSides> sides = sides_of(surface);
  for (const double x : {-1e-8, 0.0, 1e-8}) {
    const Vector3 place(x, 0, 5e-5);
    REQUIRE(caster.closest(place).distance > 4.9e-5);
    check_outside(surface, sides, 0, place);
  }
}

TEST_CASE("A corner at which many triangles meet tells the side as one with few does") {
  for (const std::uint32_t fan : {2U, 20U, 90U, 700U}) {
    const OuterSurface surface = notched_prism(fan);
    const Caster caster(surface);
    const std::vector<FeatureSides> sides = sides_of(surface, 2e-4);
    INFO(fan << " triangles");
    // Single precision takes the corner for what is nearest there.
    const Vector3 place(2.8e-4, 8.7e-8, 2e-8);
    REQUIRE(caster.closest(place).distance > 2e-4);
    check_outside(surface, sides, 0, place);
  }
}

TEST_CASE("A side on which a sliver hangs tells no wrong side") {
  OuterSurface surface = test::surface_of(test::box({0.02, 0.02, 0.02}));
  // The diagonal of a face: its second triangle gets corners of its own, and a sliver hangs down
  // from the first.
  const auto [a, b, c] = surface.triangles[0];
  Vector3 normal = (surface.vertices[b] - surface.vertices[a])
                       .cross(surface.vertices[c] - surface.vertices[a])
                       .normalized();
  std::size_t first = 0, second = 0;
  std::uint32_t from = 0, to = 0;
  for (std::size_t k = 0; k < 3; ++k) {
    const std::uint32_t one = surface.triangles[0][k], two = surface.triangles[0][(k + 1) % 3];
    for (std::size_t t = 1; t < surface.triangles.size(); ++t) {
      const Triangle& there = surface.triangles[t];
      const bool shared = std::count(there.begin(), there.end(), one) > 0 &&
                          std::count(there.begin(), there.end(), two) > 0;
      const double across = (surface.vertices[one] - surface.vertices[two]).norm();
      if (!shared || across < 0.025) continue;
      second = t;
      from = one;
      to = two;
    }
  }
  REQUIRE(second > 0);
  const auto copies = static_cast<std::uint32_t>(surface.vertices.size());
  surface.vertices.push_back(surface.vertices[from]);
  surface.vertices.push_back(surface.vertices[to]);
  const Vector3 middle = (surface.vertices[from] + surface.vertices[to]) / 2;
  surface.vertices.push_back(middle - 2.5e-7 * normal);
  for (std::uint32_t& corner : surface.triangles[second]) {
    if (corner == from) corner = copies;
    if (corner == to) corner = copies + 1;
  }
  surface.triangles.push_back({to, from, copies + 2});
  surface.solid_count = surface.triangles.size();
  const std::vector<FeatureSides> sides = sides_of(surface, 1e-4, 1e-6, 1e-6);
  const Vector3 beside = middle + 0.1 * (surface.vertices[from] - middle);
  const Triangle& triangle = surface.triangles[first];
  for (const double height : {-1e-4, 1e-4}) {
    const ClosestFeature closest =
        closest_feature(beside + height * normal, surface.vertices[triangle[0]],
                        surface.vertices[triangle[1]], surface.vertices[triangle[2]]);
    for (const TriangleFeature side :
         {TriangleFeature::ab, TriangleFeature::bc, TriangleFeature::ca}) {
      const std::size_t k = static_cast<std::size_t>(side) - 1;
      if (triangle[k] != from && triangle[(k + 1) % 3] != from) continue;
      if (triangle[k] != to && triangle[(k + 1) % 3] != to) continue;
      CHECK(side_told(sides[first], side, height).value_or(height < 0) == (height < 0));
    }
    CHECK(std::abs((closest.point - beside).norm()) < 1e-6);
  }
}

TEST_CASE(
    "A low triangle that is no sliver keeps its side, also where the surface was displaced by "
    "more") {
  OuterSurface surface = test::surface_of(test::box({0.02, 0.02, 0.02}));
  const std::vector<FeatureSides> whole = sides_of(surface);
  // From c to a leads the face's own diagonal, which is flat.
  Triangle& turned = surface.triangles[0];
  for (unsigned k = 0; side_told(whole[0], static_cast<TriangleFeature>(3 - k), -1) != true; ++k) {
    std::rotate(turned.begin(), std::next(turned.begin(), 2), turned.end());
  }
  const auto [a, b, c] = turned;
  const Vector3 first = surface.vertices[a], across = surface.vertices[b] - surface.vertices[c];
  const Vector3 normal = across.cross(surface.vertices[c] - first).normalized();
  // A strip, 10 um high, is cut off. Above it, nearer than the tolerance, is another box.
  const auto cut = static_cast<std::uint32_t>(surface.vertices.size());
  surface.vertices.push_back(surface.vertices[c] + 1e-5 * across.normalized());
  surface.triangles[0] = {a, b, cut};
  surface.triangles.push_back({a, cut, c});
  // So is the triangle beyond.
  for (std::size_t t = 1; t < whole.size(); ++t) {
    Triangle& beyond = surface.triangles[t];
    const auto from = std::find(beyond.begin(), beyond.end(), c);
    if (from == beyond.end()) continue;
    std::rotate(beyond.begin(), from, beyond.end());
    if (beyond[1] != b) continue;
    const Triangle rest{cut, b, beyond[2]};
    beyond[1] = cut;
    surface.triangles.push_back(rest);
    break;
  }
  const OuterSurface other = test::surface_of(test::box({0.02, 0.02, 0.02}));
  const auto corners = static_cast<std::uint32_t>(surface.vertices.size());
  for (const Vector3& vertex : other.vertices) {
    surface.vertices.push_back(vertex - (0.02 + 1.5e-4) * normal);
  }
  for (const Triangle& triangle : other.triangles) {
    surface.triangles.push_back(
        {triangle[0] + corners, triangle[1] + corners, triangle[2] + corners});
  }
  surface.solid_count = surface.triangles.size();
  const std::vector<FeatureSides> sides = sides_of(surface, 1e-4, 1.4e-5, 2e-6);
  for (const double height : {-1e-4, 1e-4}) {
    CHECK(side_told(sides[0], TriangleFeature::ca, height) == (height < 0));
  }
}

TEST_CASE(
    "A flat side that runs beside an edge of a box from the same corner leaves the side to "
    "crossings") {
  OuterSurface surface = test::surface_of(test::box({0.02, 0.02, 0.02}));
  const std::vector<FeatureSides> whole = sides_of(surface);
  // The first side that is none of a face's own diagonals.
  std::size_t k = 0;
  while (side_told(whole[0], static_cast<TriangleFeature>(1 + k), -1) == true) ++k;
  const Triangle first = surface.triangles[0];
  const std::uint32_t p = first[k], q = first[(k + 1) % 3], r = first[(k + 2) % 3];
  const Vector3 from = surface.vertices[q];
  const Vector3 inward = (surface.vertices[r] - from) + (surface.vertices[p] - from);
  const auto cut = static_cast<std::uint32_t>(surface.vertices.size());
  surface.vertices.push_back(from + 5e-6 * inward.normalized());
  surface.triangles[0] = {p, q, cut};
  surface.triangles.push_back({q, r, cut});
  const auto beside = static_cast<std::uint32_t>(surface.triangles.size());
  surface.triangles.push_back({r, p, cut});
  surface.solid_count = surface.triangles.size();
  const std::vector<FeatureSides> sides = sides_of(surface, 1e-4, 0, 2e-6);
  // Places beside the edge are outside, also those below the plane of the sliver.
  CHECK_FALSE(side_told(sides[0], TriangleFeature::ca, -1));
  CHECK_FALSE(side_told(sides[0], TriangleFeature::ca, 1));
  CHECK_FALSE(side_told(sides[beside], TriangleFeature::bc, -1));
  CHECK(side_told(sides[0], TriangleFeature::ab, -1) == false);
}

TEST_CASE("Around a box all sides and corners are convex, and the faces' own diagonals are flat") {
  const OuterSurface surface = test::surface_of(test::box({0.02, 0.02, 0.02}));
  const std::vector<FeatureSides> sides = sides_of(surface);
  for (std::size_t t = 0; t < sides.size(); ++t) {
    CHECK(side_told(sides[t], TriangleFeature::a, -1) == false);
    CHECK(side_told(sides[t], TriangleFeature::b, -1) == false);
    CHECK(side_told(sides[t], TriangleFeature::c, -1) == false);
    CHECK(side_told(sides[t], TriangleFeature::face, -1) == true);
    int flat = 0;
    for (const TriangleFeature side :
         {TriangleFeature::ab, TriangleFeature::bc, TriangleFeature::ca}) {
      flat += side_told(sides[t], side, -1) == true ? 1 : 0;
    }
    CHECK(flat == 1);
  }
}

TEST_CASE(
    "The nearest triangle tells the side of every place, at sharp and at concave features too") {
  const test::Shape box = test::box({0.02, 0.02, 0.02});
  const test::Shape hollow =
      test::merged(box, test::turned_inside_out(test::box({0.01, 0.01, 0.01})));
  for (const test::Shape& shape :
       {hollow, test::wedge(0.1, 0.02), test::cylinder(0.01, 0.02, 5), test::sphere(0.01, 1)}) {
    const OuterSurface surface = test::surface_of(shape);
    const Caster caster(surface);
    const std::vector<FeatureSides> sides = sides_of(surface);
    int told = 0;
    for (std::uint64_t i = 0; i < 3000; ++i) {
      const Vector3 point =
          0.04 * Vector3(random_unit(1, 3 * i) - 0.5, random_unit(1, 3 * i + 1) - 0.5,
                         random_unit(1, 3 * i + 2) - 0.5);
      const double truth = caster.closest(point).distance;
      if (std::abs(truth) < 1e-7) continue;
      INFO(point.transpose() << ": " << truth);
      const std::optional<bool> side = told_inside(surface, sides, point);
      told += side ? 1 : 0;
      CHECK(side.value_or(truth < 0) == (truth < 0));
    }
    CHECK(told > 2900);
  }
}

TEST_CASE("Nothing of a sheet without thickness tells a side by itself") {
  OuterSurface sheet;
  sheet.vertices = {{0, 0, 0}, {0.01, 0, 0}, {0.01, 0.01, 0}, {0, 0.01, 0}};
  sheet.triangles = {{0, 1, 2}, {0, 2, 3}, {0, 2, 1}, {0, 3, 2}};
  sheet.solid_count = 4;
  for (const FeatureSides side : sides_of(sheet)) {
    for (unsigned feature = 0; feature <= 6; ++feature) {
      CHECK_FALSE(side_told(side, static_cast<TriangleFeature>(feature), -1).value_or(false));
    }
    CHECK_FALSE(side_told(side, TriangleFeature::face, -1));
  }
}

}  // namespace spm::baker::feature_sides_test
