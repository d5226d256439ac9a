// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include "baker/pipeline/bake.hpp"
#include "baker/surface/outer_surface.hpp"
#include "tests/support/shapes.hpp"

namespace spm::test {

/// A shape as the baker's loader would hand it on.
[[nodiscard]] inline baker::Mesh mesh_of(const Shape& shape) {
  baker::Mesh mesh;
  mesh.vertices = shape.vertices;
  mesh.triangles = shape.triangles;
  mesh.path = "shape.obj";
  mesh.sha256 = std::string(64, '0');
  mesh.box_min = mesh.box_max = shape.vertices.front();
  for (const Vector3& vertex : shape.vertices) {
    mesh.box_min = mesh.box_min.cwiseMin(vertex);
    mesh.box_max = mesh.box_max.cwiseMax(vertex);
  }
  mesh.diagonal = (mesh.box_max - mesh.box_min).norm();
  mesh.file_triangles = mesh.triangles.size();
  mesh.file_vertices = mesh.vertices.size();
  mesh.components = 1;
  return mesh;
}

[[nodiscard]] inline baker::OuterSurface surface_of(const Shape& shape) {
  baker::OuterSurface surface;
  surface.vertices = shape.vertices;
  surface.triangles = shape.triangles;
  surface.solid_count = shape.triangles.size();
  return surface;
}

}  // namespace spm::test
