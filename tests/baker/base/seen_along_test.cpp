// SPDX-License-Identifier: GPL-3.0-or-later
#include "baker/base/seen_along.hpp"

#include <algorithm>
#include <array>
#include <catch2/catch.hpp>
#include <cstdint>
#include <vector>

#include "common/base/random.hpp"

namespace spm::baker::seen_along_test {
namespace {

Vector3 anywhere(std::uint64_t seed, std::uint64_t number) {
  const auto unit = [&](std::uint64_t k) { return 2 * random_unit(seed, 3 * number + k) - 1; };
  return {unit(0), unit(1), unit(2)};
}

TEST_CASE("A triangle is found over every place of it, whatever its shape") {
  for (const Vector3& way : {Vector3(0.03, -0.06, 1), Vector3(1, 0.02, 0.05), Vector3(0, 1, 0)}) {
    std::vector<std::array<Vector3, 3>> triangles;
    for (std::uint64_t i = 0; i < 300; ++i) {
      const Vector3 at = anywhere(1, i);
      // Slivers, triangles in rows of cells, and such as stand along the way.
      const double thin = i % 3 == 0 ? 1e-9 : 1;
      triangles.push_back({at, at + anywhere(2, i), at + anywhere(2, i) + thin * anywhere(3, i)});
      if (i % 5 == 0) triangles.back()[1] = at + way;
      if (i % 7 == 0) triangles.back()[1].y() = at.y();
    }
    const SeenAlong seen(way, triangles);
    std::size_t missed = 0, listed = 0;
    for (std::uint32_t i = 0; i < triangles.size(); ++i) {
      const auto& [a, b, c] = triangles[i];
      for (std::uint64_t k = 0; k < 40; ++k) {
        double u = random_unit(4, 2 * k), v = random_unit(4, 2 * k + 1);
        if (u + v > 1) u = 1 - u, v = 1 - v;
        // Corners and sides as well.
        if (k < 3) u = k == 1 ? 1 : 0, v = k == 2 ? 1 : 0;
        const Vector3 over = a + u * (b - a) + v * (c - a) + 3 * random_unit(5, k) * way;
        const auto found = seen.over(over);
        missed += std::find(found.begin(), found.end(), i) == found.end() ? 1 : 0;
        listed += found.size();
      }
    }
    CHECK(missed == 0);
    CHECK(listed < triangles.size() * triangles.size() * 40 / 3);
  }
}

TEST_CASE("Where thousands lie close together few are found over a place, and that one of them") {
  std::vector<std::array<Vector3, 3>> triangles{
      {Vector3(-50, -50, 0), Vector3(50, -50, 0), Vector3(0, 50, 0)}};
  for (std::uint64_t i = 0; i < 4000; ++i) {
    const Vector3 at = 0.5 * anywhere(7, i);
    triangles.push_back({at, at + 0.01 * anywhere(8, i), at + 0.01 * anywhere(9, i)});
  }
  const SeenAlong seen(Vector3(0.02, -0.03, 1), triangles);
  std::size_t missed = 0, listed = 0;
  for (std::uint32_t i = 1; i < triangles.size(); ++i) {
    const auto& [a, b, c] = triangles[i];
    const auto found = seen.over(0.3 * a + 0.3 * b + 0.4 * c);
    missed += std::find(found.begin(), found.end(), i) == found.end() ? 1 : 0;
    missed += std::find(found.begin(), found.end(), 0) == found.end() ? 1 : 0;
    listed += found.size();
  }
  CHECK(missed == 0);
  CHECK(listed < 100 * triangles.size());
}

TEST_CASE("Beside all triangles there is none, and of none neither") {
  const std::vector<std::array<Vector3, 3>> one{
      {Vector3(0, 0, 0), Vector3(1, 0, 0), Vector3(0, 1, 0)}};
  CHECK(SeenAlong(Vector3(0, 0, 1), one).over({2, 2, 0}).empty());
  CHECK(SeenAlong(Vector3(0, 0, 1), {}).over({0, 0, 0}).empty());
  CHECK(SeenAlong().over({0, 0, 0}).empty());
}

}  // namespace
}  // namespace spm::baker::seen_along_test
