// SPDX-License-Identifier: GPL-3.0-or-later
#include "baker/verify/exact_winding.hpp"

#include <CGAL/Exact_predicates_inexact_constructions_kernel.h>

#include <algorithm>
#include <array>
#include <cstdint>
#include <numeric>
#include <optional>
#include <span>
#include <vector>

#include "baker/base/seen_along.hpp"

namespace spm::baker {
namespace {

using Kernel = CGAL::Exact_predicates_inexact_constructions_kernel;
using Point = Kernel::Point_3;

Point to_cgal(const Vector3& p) { return {p.x(), p.y(), p.z()}; }

enum class Meets : std::uint8_t { not_at_all, along_normal, against_normal, at_border };

/// How a way from `from` to beyond all triangles meets one. On the triangle's plane it meets it.
Meets meeting(const Point& from, const Point& to, const Kernel::Triangle_3& t) {
  bool is_left = false, is_right = false, at_border = false;
  for (int k = 0; k < 3; ++k) {
    const CGAL::Orientation turn = CGAL::orientation(from, to, t[k], t[(k + 1) % 3]);
    is_left = is_left || turn == CGAL::POSITIVE;
    is_right = is_right || turn == CGAL::NEGATIVE;
    at_border = at_border || turn == CGAL::ZERO;
    if (is_left && is_right) return Meets::not_at_all;
  }
  const CGAL::Orientation beside = CGAL::orientation(t[0], t[1], t[2], from);
  // In the plane of a triangle it meets the border, too.
  if (!is_left && !is_right) return Meets::at_border;
  if (beside == (is_left ? CGAL::POSITIVE : CGAL::NEGATIVE)) return Meets::not_at_all;
  if (at_border) return Meets::at_border;
  return is_left ? Meets::along_normal : Meets::against_normal;
}

}  // namespace

struct ExactWinding::Implementation {
  std::vector<Kernel::Triangle_3> triangles;
  std::vector<std::uint32_t> all;  ///< their numbers
  Vector3 box_min, box_max;
  std::array<Vector3, 3> ways;  ///< in general directions, first across the box
  SeenAlong seen;               ///< along the first

  explicit Implementation(const Mesh& mesh) : box_min(mesh.box_min), box_max(mesh.box_max) {
    std::vector<std::array<Vector3, 3>> corners;
    for (std::size_t i = 0; i < mesh.solid_triangles(); ++i) {
      const auto& [a, b, c] = mesh.triangles[i];
      const std::array<Vector3, 3> own{mesh.vertices[a], mesh.vertices[b], mesh.vertices[c]};
      const Kernel::Triangle_3 triangle(to_cgal(own[0]), to_cgal(own[1]), to_cgal(own[2]));
      if (triangle.is_degenerate()) continue;
      triangles.push_back(triangle);
      corners.push_back(own);
    }
    all.resize(triangles.size());
    std::iota(all.begin(), all.end(), 0);
    int across = 0;
    (box_max - box_min).minCoeff(&across);
    for (int k = 0; k < 3; ++k) {
      Vector3& way = ways[static_cast<std::size_t>(k)] = Vector3(0.0371, -0.0613, 0.0289);
      way[(across + k) % 3] = 1;
    }
    if (!triangles.empty()) seen = SeenAlong(ways[0], corners);
  }

  /// Where a way from a point leads out of the box, to the nearer end or to the other.
  [[nodiscard]] Vector3 end_of(const Vector3& way, const Vector3& point, bool nearer) const {
    int axis = 0;
    way.cwiseAbs().maxCoeff(&axis);
    const double above = box_max[axis] - point[axis], below = point[axis] - box_min[axis];
    const bool up = (above < below) == nearer;
    const double far = std::max(up ? above : below, 0.0) + (box_max - box_min).norm();
    return point + (up ? far : -far) * way;
  }

  /// Nothing where the way passes the border of a triangle, unless these are to be left out.
  [[nodiscard]] std::optional<int> turns(const Point& from, const Point& to,
                                         std::span<const std::uint32_t> among, bool borders) const {
    int winding = 0;
    for (const std::uint32_t one : among) {
      const Meets how = meeting(from, to, triangles[one]);
      if (how == Meets::at_border && !borders) return std::nullopt;
      winding += how == Meets::along_normal ? 1 : how == Meets::against_normal ? -1 : 0;
    }
    return winding;
  }
};

ExactWinding::ExactWinding(const Mesh& mesh)
    : implementation_(std::make_unique<Implementation>(mesh)) {}

ExactWinding::~ExactWinding() = default;

int ExactWinding::at(const Vector3& point) const {
  const Implementation& self = *implementation_;
  if (self.triangles.empty()) return 0;
  const Point from = to_cgal(point);
  const std::vector<std::uint32_t> seen = self.seen.over(point);
  for (const Vector3& way : self.ways) {
    const std::span<const std::uint32_t> among = &way == self.ways.data() ? seen : self.all;
    for (const bool nearer : {true, false}) {
      const Vector3 to = self.end_of(way, point, nearer);
      if (const auto winding = self.turns(from, to_cgal(to), among, false)) return *winding;
    }
  }
  return *self.turns(from, to_cgal(self.end_of(self.ways[0], point, true)), self.all, true);
}

}  // namespace spm::baker
