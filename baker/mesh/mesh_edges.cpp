// SPDX-License-Identifier: GPL-3.0-or-later
#include "baker/mesh/mesh_edges.hpp"

#include <tbb/parallel_sort.h>

#include <tuple>

namespace spm::baker {

std::vector<HalfEdge> sorted_edges(const std::vector<Triangle>& triangles) {
  std::vector<HalfEdge> edges;
  edges.reserve(triangles.size() * 3);
  for (std::uint32_t t = 0; t < triangles.size(); ++t) {
    for (std::size_t k = 0; k < 3; ++k) {
      const std::uint32_t from = triangles[t][k];
      const std::uint32_t to = triangles[t][(k + 1) % 3];
      edges.push_back({std::min(from, to), std::max(from, to), t, from < to});
    }
  }
  tbb::parallel_sort(edges.begin(), edges.end(), [](const HalfEdge& a, const HalfEdge& b) {
    return std::tie(a.low, a.high, a.triangle) < std::tie(b.low, b.high, b.triangle);
  });
  return edges;
}

Groups parts_over(const std::vector<HalfEdge>& edges, std::size_t triangles) {
  Groups parts(triangles);
  for_each_edge(edges, [&](std::span<const HalfEdge> users) {
    for (const HalfEdge& user : users.subspan(1)) parts.join(users[0].triangle, user.triangle);
  });
  return parts;
}

std::vector<HalfEdge> outline(std::span<const Vector3> vertices,
                              const std::vector<Triangle>& triangles) {
  const auto normal = [&](const HalfEdge& user) {
    const auto& [a, b, c] = triangles[user.triangle];
    return Vector3((vertices[b] - vertices[a]).cross(vertices[c] - vertices[a]));
  };
  std::vector<HalfEdge> sides;
  for_each_edge(sorted_edges(triangles), [&](std::span<const HalfEdge> users) {
    const bool is_between = users.size() == 2 && users[0].forward != users[1].forward &&
                            normal(users[0]).dot(normal(users[1])) > 0;
    if (!is_between) sides.push_back(users[0]);
  });
  return sides;
}

std::vector<char> open_vertices(std::size_t vertices, const std::vector<Triangle>& triangles) {
  std::vector<char> open(vertices, 0);
  for_each_edge(sorted_edges(triangles), [&](std::span<const HalfEdge> users) {
    if (users[0].low == users[0].high || is_balanced(users)) return;
    open[users[0].low] = open[users[0].high] = 1;
  });
  return open;
}

}  // namespace spm::baker
