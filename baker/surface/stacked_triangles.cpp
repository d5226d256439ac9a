// SPDX-License-Identifier: GPL-3.0-or-later
#include "baker/surface/stacked_triangles.hpp"

#include <cstdint>

namespace spm::baker {
namespace {

/// A place of the projection, rounded.
[[nodiscard]] Vector3 near(const ExactKernel::Point_2& place) {
  return {CGAL::to_double(place.x()), CGAL::to_double(place.y()), 0};
}

}  // namespace

CGAL::Bounded_side StackedTriangle::side_of(const ExactKernel::Point_2& place) const {
  bool on_line = false;
  for (std::size_t k = 0; k < 3; ++k) {
    const CGAL::Orientation own = CGAL::orientation(corners_[k], corners_[(k + 1) % 3], place);
    if (own == -turn_) return CGAL::ON_UNBOUNDED_SIDE;
    on_line = on_line || own == CGAL::ZERO;
  }
  return on_line ? CGAL::ON_BOUNDARY : CGAL::ON_BOUNDED_SIDE;
}

Stack::Stack(const std::vector<std::array<ExactKernel::Point_2, 3>>& triangles) {
  std::vector<std::array<Vector3, 3>> rounded;
  for (const auto& corners : triangles) {
    triangles_.emplace_back(corners);
    rounded.push_back({near(corners[0]), near(corners[1]), near(corners[2])});
  }
  seen_ = SeenAlong(Vector3::UnitZ(), rounded);
}

/// The same at a place; nothing where it lies on a side of one.
std::optional<int> Stack::at(const ExactKernel::Point_2& place) const {
  int sum = 0;
  for (const std::uint32_t one : seen_.over(near(place))) {
    const CGAL::Bounded_side side = triangles_[one].side_of(place);
    if (side == CGAL::ON_BOUNDARY) return std::nullopt;
    if (side == CGAL::ON_BOUNDED_SIDE) sum += triangles_[one].turn();
  }
  return sum;
}

int Stack::over(const std::array<ExactKernel::Point_2, 3>& triangle) const {
  // The first place on a curve that no side passes. Any line passes the curve twice at most.
  const auto& [a, b, c] = triangle;
  using Number = ExactKernel::FT;
  for (int k = 1;; ++k) {
    const auto place = CGAL::barycenter(a, Number(97 + k), b, Number(101 + k * k), c, Number(103));
    if (const auto sum = at(place)) return *sum;
  }
}

}  // namespace spm::baker
