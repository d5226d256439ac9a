// SPDX-License-Identifier: GPL-3.0-or-later
#include "tests/bench/geometry/triangle_neighbours.hpp"

#include <cstddef>

#include "common/surface/closest_on_triangle.hpp"

namespace spm::bench {
namespace {

/// Whether a place in a triangle is within `tie` of its border.
bool on_border(const std::array<Vector3, 3>& corners, const Vector3& closest_point,
               double tie) noexcept {
  for (std::size_t k = 0; k < 3; ++k) {
    const Vector3 edge = corners[(k + 1) % 3] - corners[k];
    if (edge.cross(closest_point - corners[k]).squaredNorm() <= tie * tie * edge.squaredNorm())
      return true;
  }
  return false;
}

}  // namespace

TriangleNeighbours::TriangleNeighbours(const FloatMesh& mesh)
    : first_(mesh.vertices.size() + 1, 0), triangles_(3 * mesh.triangles.size()) {
  for (const auto& triangle : mesh.triangles) {
    for (const std::uint32_t vertex : triangle) ++first_[vertex];
  }
  std::uint32_t end = 0;
  for (std::uint32_t& first : first_) first = end += first;
  for (std::size_t i = mesh.triangles.size(); i-- > 0;) {
    for (const std::uint32_t vertex : mesh.triangles[i]) {
      triangles_[--first_[vertex]] = static_cast<std::uint32_t>(i);
    }
  }
}

Answer TriangleNeighbours::answer(const FloatMesh& mesh, const Vector3& point,
                                  std::uint32_t triangle, double tie) const noexcept {
  NearestPoint nearest(point, tie);
  const auto show = [&](std::uint32_t shown) {
    const std::array<Vector3, 3> corners = mesh.corners(shown);
    const Vector3 closest_point = closest_on_triangle(point, corners[0], corners[1], corners[2]);
    nearest.show(closest_point, corners[0], corners[1], corners[2]);
    return on_border(corners, closest_point, tie);
  };
  if (!show(triangle)) return nearest.answer();
  for (const std::uint32_t vertex : mesh.triangles[triangle]) {
    for (std::uint32_t i = first_[vertex]; i < first_[vertex + 1]; ++i) {
      if (triangles_[i] != triangle) show(triangles_[i]);
    }
  }
  return nearest.answer();
}

}  // namespace spm::bench
