// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <algorithm>
#include <cstdint>
#include <map>
#include <utility>
#include <vector>

#include "baker/mesh/sliver_removal.hpp"
#include "tests/support/shapes.hpp"

namespace spm::test {

[[nodiscard]] inline std::vector<baker::LooseTriangle> loose(const Shape& shape) {
  std::vector<baker::LooseTriangle> triangles;
  for (const auto& corners : shape.triangles) triangles.push_back({corners, false, false});
  return triangles;
}

/// Whether each side is there as often one way as the other.
[[nodiscard]] inline bool is_closed(const std::vector<baker::LooseTriangle>& triangles) {
  std::map<std::pair<std::uint32_t, std::uint32_t>, int> ways;
  for (const baker::LooseTriangle& triangle : triangles) {
    for (std::size_t k = 0; k < 3; ++k) {
      const std::uint32_t a = triangle.corners[k], b = triangle.corners[(k + 1) % 3];
      ways[std::minmax(a, b)] += a < b ? 1 : -1;
    }
  }
  return std::all_of(ways.begin(), ways.end(), [](const auto& way) { return way.second == 0; });
}

}  // namespace spm::test
