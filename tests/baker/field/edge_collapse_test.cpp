// SPDX-License-Identifier: GPL-3.0-or-later
#include "baker/field/edge_collapse.hpp"

#include <tbb/global_control.h>

#include <algorithm>
#include <catch2/catch.hpp>
#include <map>
#include <set>
#include <utility>

#include "baker/cast/cast.hpp"
#include "common/base/random.hpp"
#include "tests/baker/field/loose_triangles.hpp"
#include "tests/support/shapes.hpp"

namespace spm::baker::edge_collapse_test {

using test::is_closed;
using test::loose;
namespace {

constexpr CollapseRules rules{.displacement = 1e-4, .height = 1e-6, .min_cosine = 0.99};

OuterSurface surface_of(const test::Shape& shape, const std::vector<LooseTriangle>& triangles) {
  OuterSurface surface;
  surface.vertices = shape.vertices;
  for (const LooseTriangle& triangle : triangles) surface.triangles.push_back(triangle.corners);
  surface.solid_count = surface.triangles.size();
  return surface;
}

struct Collapsed {
  std::vector<LooseTriangle> triangles;
  std::vector<double> moved;
};

Collapsed collapsed(const test::Shape& shape, const CollapseRules& by = rules) {
  Collapsed result{loose(shape), {}};
  const Caster caster(surface_of(shape, result.triangles));
  result.moved = collapse_edges(shape.vertices, caster, by, result.triangles);
  return result;
}

/// A box whose faces are grids of so many squares along each side.
test::Shape gridded_box(const Vector3& size, int squares) {
  test::Shape shape;
  std::map<std::array<int, 3>, std::uint32_t> numbers;
  const auto corner = [&](const std::array<int, 3>& at) {
    const auto [found, fresh] =
        numbers.try_emplace(at, static_cast<std::uint32_t>(shape.vertices.size()));
    if (fresh) {
      shape.vertices.emplace_back(size.cwiseProduct(Vector3(at[0], at[1], at[2])) / squares);
    }
    return found->second;
  };
  for (std::size_t axis = 0; axis < 3; ++axis) {
    for (const bool upper : {false, true}) {
      for (int i = 0; i < squares; ++i) {
        for (int k = 0; k < squares; ++k) {
          std::array<std::uint32_t, 4> square{};
          for (std::size_t n = 0; n < 4; ++n) {
            std::array<int, 3> at{};
            at[axis] = upper ? squares : 0;
            at[(axis + 1) % 3] = i + (n == 1 || n == 2 ? 1 : 0);
            at[(axis + 2) % 3] = k + (n >= 2 ? 1 : 0);
            square[n] = corner(at);
          }
          if (!upper) std::swap(square[1], square[3]);
          shape.triangles.push_back({square[0], square[1], square[2]});
          shape.triangles.push_back({square[0], square[2], square[3]});
        }
      }
    }
  }
  return shape;
}

Vector3 random_place(const test::Shape& shape, const Triangle& triangle, std::uint64_t number) {
  double u = random_unit(7, 2 * number), v = random_unit(7, 2 * number + 1);
  if (u + v > 1) {
    u = 1 - u;
    v = 1 - v;
  }
  const auto& at = shape.vertices;
  return at[triangle[0]] + u * (at[triangle[1]] - at[triangle[0]]) +
         v * (at[triangle[2]] - at[triangle[0]]);
}

double farthest(const test::Shape& shape, const std::vector<LooseTriangle>& from,
                const std::vector<LooseTriangle>& to) {
  const Caster caster(surface_of(shape, to));
  double most = 0;
  std::uint64_t number = 0;
  for (const LooseTriangle& triangle : from) {
    for (int n = 0; n < 20; ++n) {
      const Vector3 place = random_place(shape, triangle.corners, ++number);
      most = std::max(most, std::abs(caster.closest(place).distance));
    }
  }
  return most;
}

}  // namespace

TEST_CASE("Flat faces keep the vertices of their edges alone, and nothing moves") {
  const test::Shape box = gridded_box({0.01, 0.02, 0.03}, 24);
  const Collapsed result = collapsed(box);
  CHECK(result.triangles.size() < box.triangles.size() / 2);
  CHECK(is_closed(result.triangles));
  CHECK(*std::max_element(result.moved.begin(), result.moved.end()) < 1e-9);
  CHECK(farthest(box, result.triangles, loose(box)) < 1e-9);
}

TEST_CASE("A round surface moves by no more than it says, either way, and uses what it may") {
  const test::Shape sphere = test::sphere(0.01, 5);
  const Collapsed result = collapsed(sphere);
  CHECK(result.triangles.size() < sphere.triangles.size() / 3);
  CHECK(result.moved.size() == result.triangles.size());
  CHECK(is_closed(result.triangles));
  const double most = *std::max_element(result.moved.begin(), result.moved.end());
  CHECK(most <= rules.displacement);
  CHECK(most > rules.displacement / 2);
  CHECK(farthest(sphere, result.triangles, loose(sphere)) <= most + 1e-9);
  CHECK(farthest(sphere, loose(sphere), result.triangles) <= most + 1e-9);
}

TEST_CASE("Every triangle that is left is as near to the surface as it says") {
  const test::Shape sphere = test::sphere(0.01, 4);
  const Collapsed result = collapsed(sphere);
  const Caster caster(surface_of(sphere, loose(sphere)));
  bool any = false;
  for (std::size_t t = 0; t < result.triangles.size(); ++t) {
    for (std::uint64_t n = 0; n < 10; ++n) {
      const Vector3 place = random_place(sphere, result.triangles[t].corners, 10 * t + n);
      REQUIRE(std::abs(caster.closest(place).distance) <= result.moved[t] + 1e-9);
    }
    any = any || result.moved[t] > 0;
  }
  CHECK(any);
}

TEST_CASE("Sheets that are closer than the surface may move to be safe stay as they are") {
  const test::Shape sheet = gridded_box({0.01, 0.01, rules.displacement}, 8);
  CHECK(collapsed(sheet).triangles.size() == sheet.triangles.size());
}

TEST_CASE("Vertices beside a hole and of sheets stay") {
  test::Shape box = gridded_box({0.01, 0.01, 0.01}, 16);
  box.triangles.erase(box.triangles.begin(), box.triangles.begin() + 2);
  std::vector<LooseTriangle> triangles = loose(box);
  const Caster caster(surface_of(box, triangles));
  // One of a face is of a sheet.
  const std::set<std::uint32_t> kept(triangles[10].corners.begin(), triangles[10].corners.end());
  triangles[10].sheet = true;
  (void)collapse_edges(box.vertices, caster, rules, triangles);
  std::map<std::pair<std::uint32_t, std::uint32_t>, int> ways;
  std::set<std::uint32_t> left;
  std::size_t sheets = 0;
  for (const LooseTriangle& triangle : triangles) {
    sheets += triangle.sheet ? 1 : 0;
    left.insert(triangle.corners.begin(), triangle.corners.end());
    for (std::size_t k = 0; k < 3; ++k) {
      const std::uint32_t a = triangle.corners[k], b = triangle.corners[(k + 1) % 3];
      ways[std::minmax(a, b)] += a < b ? 1 : -1;
    }
  }
  CHECK(sheets == 1);
  CHECK(std::includes(left.begin(), left.end(), kept.begin(), kept.end()));
  CHECK(std::count_if(ways.begin(), ways.end(), [](const auto& w) { return w.second != 0; }) == 4);
}

TEST_CASE("Threads change nothing of what is left") {
  const test::Shape sphere = test::sphere(0.01, 5);
  const auto with = [&](std::size_t threads) {
    const tbb::global_control limit(tbb::global_control::max_allowed_parallelism, threads);
    std::vector<Triangle> corners;
    for (const LooseTriangle& triangle : collapsed(sphere).triangles) {
      corners.push_back(triangle.corners);
    }
    return corners;
  };
  CHECK(with(1) == with(4));
}

}  // namespace spm::baker::edge_collapse_test
