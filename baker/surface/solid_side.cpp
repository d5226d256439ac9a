// SPDX-License-Identifier: GPL-3.0-or-later
#include "baker/surface/solid_side.hpp"

#include <CGAL/Exact_predicates_inexact_constructions_kernel.h>

#include <Eigen/Geometry>
#include <cmath>
#include <cstdlib>

namespace spm::baker {
namespace {

using Kernel = CGAL::Exact_predicates_inexact_constructions_kernel;

[[nodiscard]] Kernel::Point_3 exactly(const Vector3& p) { return {p.x(), p.y(), p.z()}; }

}  // namespace

SolidSide::SolidSide(std::span<const Vector3> vertices, std::span<const Triangle> triangles)
    : angles_(vertices, triangles) {
  Eigen::AlignedBox3d box;
  for (const auto& [a, b, c] : triangles) {
    corners_.push_back({vertices[a], vertices[b], vertices[c]});
    for (const Vector3& corner : corners_.back()) box.extend(corner);
  }
  if (box.isEmpty()) return;
  diagonal_ = box.diagonal().norm();
  // Across what is seen, and along no axis, since edges and faces often are.
  int across = 0;
  box.sizes().minCoeff(&across);
  way_ = Vector3(0.0523, -0.0417, 0.0331);
  way_[across] = 1;
  seen_ = SeenAlong(way_, corners_);
}

int SolidSide::winding(const Vector3& point) const {
  const std::optional<int> crossed = crossings(point);
  return crossed ? *crossed : static_cast<int>(std::lround(angles_.at(point)));
}

/// The winding number of a place, by the ways out along a line. Nothing where that passes a side
/// of a triangle, or one way tells another number than the other.
std::optional<int> SolidSide::crossings(const Vector3& point) const {
  const Kernel::Point_3 from = exactly(point), ahead = exactly(point + diagonal_ * way_);
  int before = 0, behind = 0;
  for (const std::uint32_t one : seen_.over(point)) {
    const Kernel::Point_3 a = exactly(corners_[one][0]), b = exactly(corners_[one][1]),
                          c = exactly(corners_[one][2]);
    const std::array<int, 3> turns{CGAL::orientation(from, ahead, a, b),
                                   CGAL::orientation(from, ahead, b, c),
                                   CGAL::orientation(from, ahead, c, a)};
    const int sum = turns[0] + turns[1] + turns[2];
    if (std::abs(sum) == 3) {
      // Where the place lies behind a triangle, the line leaves by it ahead.
      const int beside = CGAL::orientation(a, b, c, from);
      if (beside == 0) return std::nullopt;
      (beside == -turns[0] ? before : behind) += turns[0];
    } else if (turns[0] * turns[1] >= 0 && turns[1] * turns[2] >= 0 && turns[2] * turns[0] >= 0) {
      return std::nullopt;
    }
  }
  // What closes is entered as often as it is left.
  return before + behind == 0 ? std::optional(before) : std::nullopt;
}

}  // namespace spm::baker
