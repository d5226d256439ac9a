// SPDX-License-Identifier: GPL-3.0-or-later
#include "baker/sheet.hpp"

#include <tbb/parallel_sort.h>

#include <algorithm>
#include <cmath>
#include <span>
#include <utility>

namespace spm::baker {
namespace {

/// A triangle's side, to be sorted next to the others along the same edge.
struct Side {
  std::array<std::uint32_t, 2> ends;
  std::uint32_t side;  ///< 3 * triangle + corner
  [[nodiscard]] bool operator<(const Side& other) const {
    return ends != other.ends ? ends < other.ends : side < other.side;
  }
};

Vector3 area_vector(const Sheet& sheet, std::uint32_t triangle) {
  const auto& [a, b, c] = sheet.triangles[triangle];
  const Vector3& from = sheet.vertices[a];
  return (sheet.vertices[b] - from).cross(sheet.vertices[c] - from) / 2;
}

double angle_between(const Vector3& a, const Vector3& b) {
  return std::atan2(a.cross(b).norm(), a.dot(b));
}

std::vector<Side> sorted_sides(const Sheet& sheet) {
  std::vector<Side> sides;
  sides.reserve(3 * sheet.triangles.size());
  for (std::uint32_t triangle = 0; triangle < sheet.triangles.size(); ++triangle) {
    for (std::uint32_t k = 0; k < 3; ++k) {
      const std::uint32_t from = sheet.triangles[triangle][k];
      const std::uint32_t to = sheet.triangles[triangle][(k + 1) % 3];
      sides.push_back({{std::min(from, to), std::max(from, to)}, 3 * triangle + k});
    }
  }
  tbb::parallel_sort(sides.begin(), sides.end());
  return sides;
}

/// The edge that a run of sides has in common.
SheetEdge edge_of(const Sheet& sheet, std::span<const Side> run) {
  SheetEdge edge;
  edge.ends = run.front().ends;
  int balance = 0;
  for (const Side& side : run) {
    const Vector3 area = area_vector(sheet, side.side / 3);
    edge.area += area.norm() / 3;
    balance += sheet.triangles[side.side / 3][side.side % 3] == edge.ends[0] ? 1 : -1;
    for (const Side& other : run) {
      if (other.side >= side.side) break;
      edge.turn = std::max(edge.turn, angle_between(area_vector(sheet, other.side / 3), area));
    }
  }
  edge.paired = balance == 0;
  edge.triangles = static_cast<int>(run.size());
  return edge;
}

constexpr std::uint32_t unplaced = 0xFFFFFFFF;

}  // namespace

SheetEdges edges_of(const Sheet& sheet) {
  const std::vector<Side> sides = sorted_sides(sheet);
  SheetEdges result;
  result.edges.reserve(sides.size() / 2);
  result.of_sides.resize(sheet.triangles.size());
  for (std::size_t first = 0; first < sides.size();) {
    std::size_t last = first;
    const auto index = static_cast<std::uint32_t>(result.edges.size());
    for (; last < sides.size() && sides[last].ends == sides[first].ends; ++last) {
      result.of_sides[sides[last].side / 3][sides[last].side % 3] = index;
    }
    result.edges.push_back(edge_of(sheet, std::span(sides).subspan(first, last - first)));
    first = last;
  }
  return result;
}

Sheet in_order_of_space(const Sheet& sheet) {
  if (sheet.vertices.empty()) return sheet;
  Vector3 low = sheet.vertices.front();
  Vector3 high = low;
  for (const Vector3& vertex : sheet.vertices) {
    low = low.cwiseMin(vertex);
    high = high.cwiseMax(vertex);
  }
  const double step = std::max((high - low).maxCoeff(), 1e-300) / 1023;
  std::vector<std::pair<std::uint32_t, std::uint32_t>> order;  // code, vertex
  std::vector<std::uint32_t> place(sheet.vertices.size(), unplaced);
  for (const Triangle& triangle : sheet.triangles) {
    for (const std::uint32_t corner : triangle) {
      if (place[corner] != unplaced) continue;
      place[corner] = 0;
      const Vector3 cell = (sheet.vertices[corner] - low) / step;
      std::uint32_t code = 0;
      for (std::uint32_t bit = 0; bit < 10; ++bit) {
        for (std::uint32_t axis = 0; axis < 3; ++axis) {
          const auto along = static_cast<std::uint32_t>(cell[static_cast<int>(axis)]);
          code |= ((along >> bit) & 1U) << (3 * bit + axis);
        }
      }
      order.emplace_back(code, corner);
    }
  }
  tbb::parallel_sort(order.begin(), order.end());
  Sheet ordered;
  ordered.vertices.reserve(order.size());
  for (const auto& [code, vertex] : order) {
    place[vertex] = static_cast<std::uint32_t>(ordered.vertices.size());
    ordered.vertices.push_back(sheet.vertices[vertex]);
  }
  ordered.triangles.reserve(sheet.triangles.size());
  for (const auto& [a, b, c] : sheet.triangles) {
    ordered.triangles.push_back({place[a], place[b], place[c]});
  }
  return ordered;
}

}  // namespace spm::baker
