// SPDX-License-Identifier: GPL-3.0-or-later
#include "baker/mesh/mesh_repair.hpp"

#include <CGAL/Exact_predicates_inexact_constructions_kernel.h>
#include <tbb/parallel_sort.h>

#include <algorithm>
#include <array>
#include <numeric>
#include <string>
#include <tuple>
#include <utility>

#include "baker/mesh/mesh_cells.hpp"
#include "baker/mesh/mesh_duplicates.hpp"
#include "baker/mesh/mesh_orient.hpp"

namespace spm::baker {
namespace {

using Kernel = CGAL::Exact_predicates_inexact_constructions_kernel;

constexpr std::uint32_t kNone = UINT32_MAX;

[[nodiscard]] Kernel::Point_3 exact_point(const Vector3& p) { return {p.x(), p.y(), p.z()}; }

/// Keeps the first of equal points and renumbers the triangles. Returns how many points were
/// dropped.
std::size_t merge_equal_points(PolygonSoup& soup) {
  std::vector<std::uint32_t> order(soup.points.size());
  std::iota(order.begin(), order.end(), 0U);
  tbb::parallel_sort(order.begin(), order.end(), [&](std::uint32_t a, std::uint32_t b) {
    const Vector3& p = soup.points[a];
    const Vector3& q = soup.points[b];
    return std::tie(p.x(), p.y(), p.z(), a) < std::tie(q.x(), q.y(), q.z(), b);
  });
  std::vector<std::uint32_t> first(soup.points.size());
  std::size_t merged = 0;
  for (std::size_t i = 0; i < order.size(); ++i) {
    const bool same = i > 0 && soup.points[order[i]] == soup.points[order[i - 1]];
    first[order[i]] = same ? first[order[i - 1]] : order[i];
    merged += same ? 1U : 0U;
  }
  for (Triangle& triangle : soup.triangles) {
    for (std::uint32_t& corner : triangle) corner = first[corner];
  }
  return merged;
}

std::size_t drop_repeated_corners(std::vector<Triangle>& triangles) {
  return std::erase_if(
      triangles, [](const Triangle& t) { return t[0] == t[1] || t[1] == t[2] || t[2] == t[0]; });
}

std::size_t drop_zero_area(const std::vector<Vector3>& points, std::vector<Triangle>& triangles) {
  return std::erase_if(triangles, [&](const Triangle& t) {
    return collinear(points[t[0]], points[t[1]], points[t[2]]);
  });
}

/// Keeps the referenced points in their order and renumbers triangles and border.
void compact(const std::vector<Vector3>& points, Mesh& mesh) {
  std::vector<std::uint32_t> renumbered(points.size(), kNone);
  for (const Triangle& triangle : mesh.triangles) {
    for (const std::uint32_t corner : triangle) renumbered[corner] = 0;
  }
  for (std::size_t i = 0; i < points.size(); ++i) {
    if (renumbered[i] == kNone) continue;
    renumbered[i] = static_cast<std::uint32_t>(mesh.vertices.size());
    mesh.vertices.push_back(points[i]);
  }
  for (Triangle& triangle : mesh.triangles) {
    for (std::uint32_t& corner : triangle) corner = renumbered[corner];
  }
  // A border along a triangle without area may lose its vertices with it.
  std::erase_if(mesh.border, [&](const std::array<std::uint32_t, 2>& edge) {
    return renumbered[edge[0]] == kNone || renumbered[edge[1]] == kNone;
  });
  for (auto& edge : mesh.border) edge = {renumbered[edge[0]], renumbered[edge[1]]};
}

[[nodiscard]] std::string counted(std::uint64_t count, const char* one, const char* many) {
  return std::to_string(count) + " " + (count == 1 ? one : many);
}

void describe(std::size_t merged, std::size_t inner, const Orientation& orientation, Mesh& mesh) {
  if (merged > 0) {
    mesh.notes.push_back(counted(merged, "vertex", "vertices") +
                         " merged with another at the same place.");
  }
  if (mesh.dropped_triangles > 0) {
    mesh.notes.push_back(counted(mesh.dropped_triangles, "triangle", "triangles") +
                         " dropped that had no area or lay on another with the same corners.");
  }
  if (inner > 0) {
    mesh.notes.push_back(counted(inner, "triangle", "triangles") +
                         " dropped that only divide a part's inside, where nothing reaches them.");
  }
  if (orientation.flipped > 0) {
    mesh.notes.push_back(counted(orientation.flipped, "triangle", "triangles") +
                         " reversed to agree with the neighbours.");
  }
  if (orientation.inverted > 0) {
    mesh.notes.push_back(counted(orientation.inverted, "part that was", "parts that were") +
                         " inside out turned, so that normals point out of the solid.");
  }
  if (orientation.unorientable > 0) {
    mesh.notes.push_back(counted(orientation.unorientable, "edge joins", "edges join") +
                         " triangles that cannot agree on an outside (a one-sided strip).");
  }
  if (orientation.nonmanifold_edges > 0) {
    mesh.notes.push_back(counted(orientation.nonmanifold_edges, "edge is", "edges are") +
                         " shared by more than two triangles.");
  }
  if (orientation.undecided > 0) {
    mesh.notes.push_back(counted(orientation.undecided, "open surface has", "open surfaces have") +
                         " no recognisable inside; the direction of the file's triangles is kept.");
  }
  if (mesh.border_edges > 0) {
    mesh.notes.push_back(
        "The mesh is open, with " + counted(mesh.border_edges, "border edge", "border edges") +
        ": sides are decided by the generalised winding number, a surface that encloses nothing is "
        "not solid, and nothing is promised about answers near the holes.");
  }
}

}  // namespace

bool collinear(const Vector3& a, const Vector3& b, const Vector3& c) {
  return CGAL::collinear(exact_point(a), exact_point(b), exact_point(c));
}

void repair(PolygonSoup soup, Mesh& mesh) {
  mesh.file_vertices = soup.points.size();
  mesh.file_triangles = soup.triangles.size();
  const std::size_t merged = merge_equal_points(soup);
  mesh.dropped_triangles = drop_repeated_corners(soup.triangles);
  mesh.dropped_triangles += drop_duplicates(soup.triangles);
  const std::size_t inner = drop_inner_faces(soup.points, soup.triangles);
  // Triangles without area are dropped last: until then they connect their neighbours.
  const Orientation orientation = orient(soup.points, soup.triangles);
  mesh.dropped_triangles += drop_zero_area(soup.points, soup.triangles);
  mesh.components = orientation.components;
  mesh.inverted_components = orientation.inverted;
  mesh.border = orientation.border;
  mesh.triangles = std::move(soup.triangles);
  compact(soup.points, mesh);
  mesh.border_edges = mesh.border.size();
  describe(merged, inner, orientation, mesh);
}

}  // namespace spm::baker
