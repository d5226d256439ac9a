// SPDX-License-Identifier: GPL-3.0-or-later
#include "baker/mesh/mesh_seams.hpp"

#include <algorithm>
#include <cstdint>
#include <map>
#include <utility>

#include "baker/mesh/join_vertices.hpp"
#include "baker/mesh/mesh_edges.hpp"

namespace spm::baker {
namespace {

/// Each round divides a triangle along one of its edges.
constexpr int most_rounds = 64;

/// Edges that one triangle has alone.
[[nodiscard]] std::vector<HalfEdge> border_edges(const std::vector<Triangle>& triangles) {
  std::vector<HalfEdge> border;
  for_each_edge(sorted_edges(triangles), [&](std::span<const HalfEdge> users) {
    if (users.size() == 1) border.push_back(users[0]);
  });
  return border;
}

[[nodiscard]] std::vector<std::uint32_t> vertices_of(const std::vector<HalfEdge>& border) {
  std::vector<std::uint32_t> vertices;
  for (const HalfEdge& edge : border) vertices.insert(vertices.end(), {edge.low, edge.high});
  std::sort(vertices.begin(), vertices.end());
  vertices.erase(std::unique(vertices.begin(), vertices.end()), vertices.end());
  return vertices;
}

Counted weld(const std::vector<Vector3>& points, double distance,
             const std::vector<HalfEdge>& border, std::vector<Triangle>& triangles) {
  const std::vector<std::uint32_t> vertices = vertices_of(border);
  std::vector<Vector3> places;
  for (const std::uint32_t vertex : vertices) places.push_back(points[vertex]);
  const std::vector<std::uint32_t> joined = join_vertices(places, distance);
  std::map<std::uint32_t, std::uint32_t> first;
  for (std::size_t i = 0; i < joined.size(); ++i) {
    if (joined[i] != i) first[vertices[i]] = vertices[joined[i]];
  }
  if (first.empty()) return {};
  for (Triangle& triangle : triangles) {
    for (std::uint32_t& corner : triangle) {
      if (const auto found = first.find(corner); found != first.end()) corner = found->second;
    }
  }
  return {first.size(), first.begin()->first};
}

/// Vertices by place, to be found near an edge.
class BorderVertices {
 public:
  BorderVertices(const std::vector<Vector3>& points, const std::vector<std::uint32_t>& vertices)
      : points_(points), vertices_(vertices) {
    std::sort(vertices_.begin(), vertices_.end(), [&](std::uint32_t a, std::uint32_t b) {
      const double x = points[a].x(), y = points[b].x();
      return x != y ? x < y : a < b;
    });
  }

  /// Those on an edge, ends left out, from its first end on.
  [[nodiscard]] std::vector<std::uint32_t> on(std::uint32_t from, std::uint32_t to,
                                              double distance) const {
    const Vector3 &a = points_[from], &b = points_[to];
    const Vector3 along = b - a;
    const double length = along.norm();
    std::vector<std::pair<double, std::uint32_t>> found;
    const double low = std::min(a.x(), b.x()) - distance, high = std::max(a.x(), b.x()) + distance;
    auto at =
        std::lower_bound(vertices_.begin(), vertices_.end(), low,
                         [&](std::uint32_t vertex, double x) { return points_[vertex].x() < x; });
    for (; at != vertices_.end() && points_[*at].x() <= high; ++at) {
      const Vector3 to_vertex = points_[*at] - a;
      const double way = along.dot(to_vertex) / length;
      if (!(way > distance && way < length - distance)) continue;
      if ((to_vertex - way / length * along).norm() <= distance) found.emplace_back(way, *at);
    }
    std::sort(found.begin(), found.end());
    std::vector<std::uint32_t> vertices;
    for (const auto& [way, vertex] : found) vertices.push_back(vertex);
    return vertices;
  }

 private:
  const std::vector<Vector3>& points_;
  std::vector<std::uint32_t> vertices_;
};

/// Divides triangles along one border edge each; returns how many, and a vertex that did.
Counted split_once(const std::vector<Vector3>& points, double distance,
                   std::vector<Triangle>& triangles) {
  const std::vector<HalfEdge> border = border_edges(triangles);
  const BorderVertices vertices(points, vertices_of(border));
  std::vector<char> divided(triangles.size(), 0);
  Counted split;
  for (const HalfEdge& edge : border) {
    if (divided[edge.triangle] != 0) continue;
    Triangle triangle = triangles[edge.triangle];
    const std::uint32_t from = edge.forward ? edge.low : edge.high,
                        to = edge.forward ? edge.high : edge.low;
    const std::vector<std::uint32_t> between = vertices.on(from, to, distance);
    while (triangle[0] != from) std::rotate(triangle.begin(), triangle.begin() + 1, triangle.end());
    const std::uint32_t tip = triangle[2];
    if (between.empty() || std::find(between.begin(), between.end(), tip) != between.end())
      continue;
    divided[edge.triangle] = 1;
    split.add(1, between.front());
    triangles[edge.triangle] = {from, between.front(), tip};
    for (std::size_t i = 0; i < between.size(); ++i) {
      triangles.push_back({between[i], i + 1 < between.size() ? between[i + 1] : to, tip});
    }
  }
  return split;
}

}  // namespace

Seams join_seams(const std::vector<Vector3>& points, double distance,
                 std::vector<Triangle>& triangles) {
  Seams seams;
  const std::vector<HalfEdge> border = border_edges(triangles);
  if (border.empty()) return seams;
  seams.border_edges = {border.size(), border.front().low};
  seams.welded = weld(points, distance, border, triangles);
  if (seams.welded.count > 0) {
    std::erase_if(triangles,
                  [](const Triangle& t) { return t[0] == t[1] || t[1] == t[2] || t[2] == t[0]; });
  }
  for (int round = 0; round < most_rounds; ++round) {
    const Counted split = split_once(points, distance, triangles);
    if (split.count == 0) break;
    seams.split.add(split.count, split.vertex);
  }
  return seams;
}

}  // namespace spm::baker
