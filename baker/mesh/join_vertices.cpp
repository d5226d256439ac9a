// SPDX-License-Identifier: GPL-3.0-or-later
#include "baker/mesh/join_vertices.hpp"

#include <array>
#include <cmath>
#include <cstddef>
#include <optional>
#include <unordered_map>
#include <utility>

namespace spm::baker {

namespace {

/// The edge of the cells that vertices are found by, in distances: so many that most vertices are
/// near to none but their own, and so few that vertices apart from each other do not fill it.
constexpr double cell_edge = 4;

using Cell = std::array<std::int64_t, 3>;

struct CellHash {
  std::size_t operator()(const Cell& cell) const noexcept {
    std::uint64_t hash = 0;
    for (const std::int64_t along : cell) {
      hash = (hash ^ static_cast<std::uint64_t>(along)) * 0x9E3779B97F4A7C15U;
      hash ^= hash >> 32U;
    }
    return hash;
  }
};

Cell cell_of(const Vector3& point, double edge) {
  Cell cell{};
  for (std::size_t axis = 0; axis < 3; ++axis) {
    cell[axis] = static_cast<std::int64_t>(std::floor(point[static_cast<int>(axis)] / edge));
  }
  return cell;
}

}  // namespace

std::vector<std::uint32_t> join_vertices(const std::vector<Vector3>& vertices, double distance) {
  constexpr std::uint32_t none = UINT32_MAX;
  const double edge = cell_edge * distance;
  // The last vertex of each cell that stands for itself, and for each of them the one before.
  std::unordered_map<Cell, std::uint32_t, CellHash> last;
  last.reserve(vertices.size());
  std::vector<std::uint32_t> before(vertices.size(), none), joined(vertices.size());
  for (std::uint32_t i = 0; i < vertices.size(); ++i) {
    // Somewhat more than the distance, so that rounding leaves no cell out.
    const Vector3 reach = Vector3::Constant((1 + 1e-6) * distance);
    const Cell low = cell_of(vertices[i] - reach, edge), high = cell_of(vertices[i] + reach, edge);
    std::optional<std::uint32_t> found;
    for (std::int64_t z = low[2]; z <= high[2]; ++z) {
      for (std::int64_t y = low[1]; y <= high[1]; ++y) {
        for (std::int64_t x = low[0]; x <= high[0]; ++x) {
          const auto there = last.find({x, y, z});
          if (there == last.end()) continue;
          for (std::uint32_t other = there->second; other != none; other = before[other]) {
            if ((vertices[other] - vertices[i]).norm() > distance) continue;
            if (!found || other < *found) found = other;
          }
        }
      }
    }
    joined[i] = found.value_or(i);
    if (found) continue;
    const auto [own, first] = last.try_emplace(cell_of(vertices[i], edge), i);
    if (!first) before[i] = std::exchange(own->second, i);
  }
  return joined;
}

}  // namespace spm::baker
