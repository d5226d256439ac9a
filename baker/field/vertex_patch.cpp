// SPDX-License-Identifier: GPL-3.0-or-later
#include "baker/field/vertex_patch.hpp"

#include <algorithm>
#include <cmath>

#include "baker/mesh/triangle_height.hpp"

namespace spm::baker {

namespace {

/// Twice the area of a triangle with a corner at the origin, seen from above the plane.
double cross(const Vector3& a, const Vector3& b) { return a.x() * b.y() - a.y() * b.x(); }

/// The two other corners of a triangle, in order.
std::array<std::uint32_t, 2> others(const Triangle& triangle, std::uint32_t vertex) {
  if (triangle[0] == vertex) return {triangle[1], triangle[2]};
  if (triangle[1] == vertex) return {triangle[2], triangle[0]};
  return {triangle[0], triangle[1]};
}

}  // namespace

std::optional<VertexPatch> VertexPatch::around(std::uint32_t vertex,
                                               const std::vector<Vector3>& vertices,
                                               const std::vector<LooseTriangle>& triangles,
                                               std::span<const std::uint32_t> star) {
  if (star.size() < 3 || star.size() > most) return std::nullopt;
  VertexPatch patch;
  patch.count_ = star.size();
  const Vector3& middle = vertices[vertex];
  std::array<std::array<std::uint32_t, 2>, most> sides{};
  Vector3 normal = Vector3::Zero();
  for (std::size_t i = 0; i < star.size(); ++i) {
    if (triangles[star[i]].sheet) return std::nullopt;
    sides[i] = others(triangles[star[i]].corners, vertex);
    normal += (vertices[sides[i][0]] - middle).cross(vertices[sides[i][1]] - middle);
  }
  if (!(normal.norm() > 0)) return std::nullopt;
  patch.normal_ = normal.normalized();
  // Each side leads on from the one before, and the last one back to the first.
  for (std::size_t i = 0; i < star.size(); ++i) {
    patch.ring_[i] = sides[i][0];
    const std::size_t next = i + 1;
    if (next == star.size()) {
      if (sides[i][1] != patch.ring_[0]) return std::nullopt;
      break;
    }
    std::size_t found = next;
    while (found < star.size() && sides[found][0] != sides[i][1]) ++found;
    if (found == star.size()) return std::nullopt;
    std::swap(sides[next], sides[found]);
  }
  const Vector3 first = patch.normal_.unitOrthogonal(), second = patch.normal_.cross(first);
  for (std::size_t i = 0; i < patch.count_; ++i) {
    const Vector3 away = vertices[patch.ring_[i]] - middle;
    patch.places_[i] = {away.dot(first), away.dot(second), away.dot(patch.normal_)};
  }
  // Once around, and nowhere back.
  int turns = 0;
  for (std::size_t i = 0; i < patch.count_; ++i) {
    const Vector3 &a = patch.place(i), &b = patch.place(i + 1);
    if (!(cross(a, b) > 0)) return std::nullopt;
    turns += a.y() < 0 && b.y() >= 0 ? 1 : 0;
  }
  return turns == 1 ? std::optional(patch) : std::nullopt;
}

std::optional<VertexPatch::Shape> VertexPatch::shape_of_fan(std::size_t k) const {
  Shape shape{std::numeric_limits<double>::infinity(), 1};
  for (std::size_t i = 1; i + 1 < count_; ++i) {
    const Vector3 a = place(k + i) - place(k), b = place(k + i + 1) - place(k);
    const Vector3 twice = a.cross(b);
    const double area = twice.norm();
    if (!(twice.z() > 0)) return std::nullopt;
    const double longest =
        std::sqrt(std::max({a.squaredNorm(), b.squaredNorm(), (b - a).squaredNorm()}));
    shape.least_height = std::min(shape.least_height, area / longest);
    shape.least_cosine = std::min(shape.least_cosine, twice.z() / area);
  }
  return shape;
}

double VertexPatch::gap_of_fan(std::size_t k) const {
  // Both are flat between the places where a line of one crosses a line of the other, and between
  // these and the vertex.
  double gap = gap_at_vertex(k);
  for (std::size_t i = 2; i + 1 < count_; ++i) gap = std::max(gap, gap_along(k, i));
  return gap;
}

/// How high the fan is over the vertex, m.
double VertexPatch::gap_at_vertex(std::size_t k) const {
  const Vector3& from = place(k);
  // The triangle below it: the vertex is on the left of one of its sides and on the right of the
  // next.
  std::size_t i = 1;
  while (i + 2 < count_ && cross(place(k + i + 1) - from, -from) >= 0) ++i;
  const Vector3 normal = (place(k + i) - from).cross(place(k + i + 1) - from);
  return std::abs(normal.dot(from) / normal.z());
}

/// How far the fan is from the triangles along its side from the k-th neighbour to the one that is
/// `to` places further, m.
double VertexPatch::gap_along(std::size_t k, std::size_t to) const {
  const Vector3& from = place(k);
  const Vector3 along = place(k + to) - from;
  const double length = along.x() * along.x() + along.y() * along.y();
  const double at_vertex = cross(along, -from);
  double gap = 0;
  for (std::size_t m = 1; m < count_; ++m) {
    if (m == to) continue;
    const Vector3& end = place(k + m);
    const double at_end = cross(along, end - from);
    if (at_vertex * at_end >= 0) continue;  // the two are on one side of the line
    const Vector3 there = at_vertex / (at_vertex - at_end) * end;
    const double share =
        (along.x() * (there.x() - from.x()) + along.y() * (there.y() - from.y())) / length;
    gap = std::max(gap, std::abs(there.z() - from.z() - share * along.z()));
  }
  return gap;
}

}  // namespace spm::baker
