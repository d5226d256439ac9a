// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <algorithm>
#include <cstdint>
#include <limits>
#include <map>
#include <numeric>
#include <utility>
#include <vector>

#include "baker/mesh/mesh.hpp"
#include "tests/support/shapes.hpp"

namespace spm::test {

/// A shape as the loader would hand it on, without its repair: box, parts; a sheet where it is
/// open.
[[nodiscard]] inline baker::Mesh as_mesh(const Shape& shape) {
  baker::Mesh mesh;
  mesh.vertices = shape.vertices;
  mesh.triangles = shape.triangles;
  mesh.path = "shape";
  mesh.box_min.setConstant(std::numeric_limits<double>::infinity());
  mesh.box_max = -mesh.box_min;
  for (const Vector3& vertex : mesh.vertices) {
    mesh.box_min = mesh.box_min.cwiseMin(vertex);
    mesh.box_max = mesh.box_max.cwiseMax(vertex);
  }
  mesh.diagonal = (mesh.box_max - mesh.box_min).norm();
  mesh.file_triangles = mesh.triangles.size();
  mesh.file_vertices = mesh.vertices.size();
  std::vector<std::uint32_t> part(mesh.vertices.size());
  std::iota(part.begin(), part.end(), 0U);
  const auto root = [&part](std::uint32_t vertex) {
    while (part[vertex] != vertex) vertex = part[vertex];
    return vertex;
  };
  std::map<std::pair<std::uint32_t, std::uint32_t>, int> uses;
  Vector3 open_area = Vector3::Zero();  // none where only a corner lies on another's edge
  for (const auto& triangle : mesh.triangles) {
    for (std::size_t i = 0; i < 3; ++i) {
      const std::uint32_t a = triangle[i];
      const std::uint32_t b = triangle[(i + 1) % 3];
      ++uses[std::minmax(a, b)];
      open_area += mesh.vertices[a].cross(mesh.vertices[b]);
      part[root(a)] = root(b);
    }
  }
  for (const auto& [edge, count] : uses) mesh.border_edges += count == 1 ? 1 : 0;
  const bool open = open_area.norm() > 1e-9 * mesh.diagonal * mesh.diagonal;
  if (mesh.border_edges > 0 && open) mesh.sheet_triangles = mesh.triangles.size();
  for (std::uint32_t vertex = 0; vertex < part.size(); ++vertex) {
    if (part[vertex] == vertex) ++mesh.components;
  }
  return mesh;
}

/// A point in the box around a mesh, grown by `grow` metres, from three numbers in [0, 1).
[[nodiscard]] inline Vector3 point_around(const baker::Mesh& mesh, double grow, double a, double b,
                                          double c) {
  const Vector3 low = mesh.box_min - Vector3::Constant(grow);
  const Vector3 size = mesh.box_max + Vector3::Constant(grow) - low;
  return low + size.cwiseProduct(Vector3(a, b, c));
}

}  // namespace spm::test
