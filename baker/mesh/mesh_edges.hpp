// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <iterator>
#include <span>
#include <vector>

#include "baker/base/groups.hpp"
#include "baker/mesh/mesh.hpp"

namespace spm::baker {

/// A side of a triangle, from its lower vertex to its higher one.
struct HalfEdge {
  std::uint32_t low, high;  ///< vertices
  std::uint32_t triangle;
  bool forward;  ///< the triangle runs from low to high
};

/// The corner of a triangle that is not on a side of it.
[[nodiscard]] inline std::uint32_t tip_of(const Triangle& triangle, const HalfEdge& side) {
  return *std::find_if(triangle.begin(), triangle.end(), [&](std::uint32_t corner) {
    return corner != side.low && corner != side.high;
  });
}

/// All edges; those of the same pair of vertices are side by side.
[[nodiscard]] std::vector<HalfEdge> sorted_edges(const std::vector<Triangle>& triangles);

/// Calls `visit` with the users of each edge, of `sorted_edges`.
template <class Visit>
void for_each_edge(const std::vector<HalfEdge>& edges, Visit visit) {
  for (std::size_t begin = 0; begin < edges.size();) {
    std::size_t end = begin + 1;
    while (end < edges.size() && edges[end].low == edges[begin].low &&
           edges[end].high == edges[begin].high) {
      ++end;
    }
    visit(std::span(edges).subspan(begin, end - begin));
    begin = end;
  }
}

/// The parts of so many triangles: those that meet at an edge are in one.
[[nodiscard]] Groups parts_over(const std::vector<HalfEdge>& edges, std::size_t triangles);

/// Whether the users of an edge pass it as often one way as the other.
[[nodiscard]] inline bool is_balanced(std::span<const HalfEdge> users) {
  return 2 * std::count_if(users.begin(), users.end(),
                           [](const HalfEdge& user) { return user.forward; }) ==
         std::ssize(users);
}

/// The sides of triangles, each once, but for those between two that face the same way.
[[nodiscard]] std::vector<HalfEdge> outline(std::span<const Vector3> vertices,
                                            const std::vector<Triangle>& triangles);

/// Of each of so many vertices, whether a side that ends there is passed more often one way than
/// the other.
[[nodiscard]] std::vector<char> open_vertices(std::size_t vertices,
                                              const std::vector<Triangle>& triangles);

}  // namespace spm::baker
