// SPDX-License-Identifier: GPL-3.0-or-later
#include "baker/mesh/mesh_cells.hpp"

#include <algorithm>
#include <cstdint>
#include <map>
#include <utility>

#include "baker/base/groups.hpp"
#include "baker/mesh/mesh_edges.hpp"
#include "baker/mesh/mesh_repair.hpp"
#include "baker/mesh/triangle_fan.hpp"

namespace spm::baker {
namespace {

/// The parts that are looked at: crowded at some edge, and made of patches that are not all closed.
[[nodiscard]] std::vector<char> divided_parts(std::span<const Vector3> points,
                                              const std::vector<Triangle>& triangles,
                                              const std::vector<HalfEdge>& edges, Groups& parts) {
  Groups patches(triangles.size());
  for_each_edge(edges, [&](std::span<const HalfEdge> users) {
    if (users.size() == 2) patches.join(users[0].triangle, users[1].triangle);
  });
  std::vector<char> crowded(triangles.size(), 0), open(triangles.size(), 0);
  for_each_edge(edges, [&](std::span<const HalfEdge> users) {
    const std::uint32_t part = parts.of(users[0].triangle);
    if (users.size() > 2) crowded[part] = 1;
    std::map<std::uint32_t, std::size_t> uses;
    for (const HalfEdge& user : users) ++uses[patches.of(user.triangle)];
    for (const auto& [patch, count] : uses) {
      if (count % 2 != 0) open[part] = 1;
    }
  });
  for (std::uint32_t t = 0; t < triangles.size(); ++t) {
    const auto& [a, b, c] = triangles[t];
    const std::uint32_t part = parts.of(t);
    if (crowded[part] != 0 && collinear(points[a], points[b], points[c])) open[part] = 0;
  }
  for (std::size_t part = 0; part < open.size(); ++part) {
    if (crowded[part] == 0) open[part] = 0;
  }
  return open;
}

/// Joins the sides of triangles that face each other around edges. Parts in which that is not clear
/// are no longer looked at.
[[nodiscard]] Groups cells_of(std::span<const Vector3> points,
                              const std::vector<Triangle>& triangles,
                              const std::vector<HalfEdge>& edges, Groups& parts,
                              std::vector<char>& divided) {
  Groups cells(2 * triangles.size());
  for_each_edge(edges, [&](std::span<const HalfEdge> users) {
    char& wanted = divided[parts.of(users[0].triangle)];
    if (wanted == 0) return;
    const std::vector<FanLeaf> fan = triangle_fan(
        triangles, users, [&](std::uint32_t vertex) { return exact_point(points[vertex]); });
    if (std::any_of(fan.begin(), fan.end(), [](const FanLeaf& leaf) { return leaf.on_last; })) {
      wanted = 0;
      return;
    }
    for (std::size_t i = 0; i < fan.size(); ++i) {
      cells.join(ahead(fan[i].user), behind(fan[(i + 1) % fan.size()].user));
    }
  });
  return cells;
}

}  // namespace

Counted drop_inner_faces(std::span<const Vector3> points, std::vector<Triangle>& triangles) {
  const std::vector<HalfEdge> edges = sorted_edges(triangles);
  bool is_crowded = false;
  for_each_edge(
      edges, [&](std::span<const HalfEdge> users) { is_crowded = is_crowded || users.size() > 2; });
  if (!is_crowded) return {};
  Groups parts = parts_over(edges, triangles.size());
  std::vector<char> divided = divided_parts(points, triangles, edges, parts);
  if (std::count(divided.begin(), divided.end(), 1) == 0) return {};
  Groups cells = cells_of(points, triangles, edges, parts, divided);

  // The outside of a part is what has its volume with the other sign.
  std::vector<double> volumes(2 * triangles.size(), 0);
  for (std::uint32_t t = 0; t < triangles.size(); ++t) {
    const std::uint32_t part = parts.of(t);
    if (divided[part] == 0) continue;
    const Vector3& origin = points[triangles[part][0]];
    const auto& [a, b, c] = triangles[t];
    const double volume = (points[a] - origin).dot((points[b] - origin).cross(points[c] - origin));
    volumes[cells.of(back(t))] += volume;
    volumes[cells.of(front(t))] -= volume;
  }
  std::map<std::uint32_t, std::uint32_t> outside;  // the cell around each part
  for (std::uint32_t t = 0; t < triangles.size(); ++t) {
    if (divided[parts.of(t)] == 0) continue;
    for (const std::uint32_t side : {front(t), back(t)}) {
      const std::uint32_t cell = cells.of(side);
      const auto [found, fresh] = outside.try_emplace(parts.of(t), cell);
      if (!fresh && volumes[cell] < volumes[found->second]) found->second = cell;
    }
  }
  Counted dropped;
  std::size_t kept = 0;
  for (std::uint32_t t = 0; t < triangles.size(); ++t) {
    Triangle triangle = triangles[t];
    if (divided[parts.of(t)] != 0) {
      const std::uint32_t around = outside.at(parts.of(t));
      const bool reached_in_front = cells.of(front(t)) == around,
                 reached_behind = cells.of(back(t)) == around;
      if (!reached_in_front && !reached_behind) {
        dropped.add(1, triangle[0]);
        continue;
      }
      if (!reached_in_front) std::swap(triangle[1], triangle[2]);
    }
    triangles[kept++] = triangle;
  }
  triangles.resize(kept);
  return dropped;
}

}  // namespace spm::baker
