// SPDX-License-Identifier: GPL-3.0-or-later
#include "baker/surface/join_vertices.hpp"

#include <array>
#include <cmath>
#include <map>
#include <optional>

namespace spm::baker {

std::vector<std::uint32_t> join_vertices(const std::vector<Vector3>& vertices, double distance) {
  using Cell = std::array<std::int64_t, 3>;
  std::map<Cell, std::vector<std::uint32_t>> cells;
  std::vector<std::uint32_t> joined(vertices.size());
  for (std::uint32_t i = 0; i < vertices.size(); ++i) {
    Cell cell{};
    for (std::size_t axis = 0; axis < 3; ++axis) {
      cell[axis] =
          static_cast<std::int64_t>(std::floor(vertices[i][static_cast<int>(axis)] / distance));
    }
    std::optional<std::uint32_t> found;
    for (int k = 0; k < 27; ++k) {
      const Cell near{cell[0] + k % 3 - 1, cell[1] + k / 3 % 3 - 1, cell[2] + k / 9 - 1};
      const auto there = cells.find(near);
      if (there == cells.end()) continue;
      for (const std::uint32_t other : there->second) {
        if ((vertices[other] - vertices[i]).norm() <= distance && (!found || other < *found)) {
          found = other;
        }
      }
    }
    joined[i] = found.value_or(i);
    if (!found) cells[cell].push_back(i);
  }
  return joined;
}

}  // namespace spm::baker
