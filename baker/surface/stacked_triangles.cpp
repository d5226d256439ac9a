// SPDX-License-Identifier: GPL-3.0-or-later
#include "baker/surface/stacked_triangles.hpp"

#include <optional>

namespace spm::baker {
namespace {

/// The same at a place; nothing where it lies on a side of one.
[[nodiscard]] std::optional<int> stacked_at(const ExactKernel::Point_2& place,
                                            const std::vector<StackedTriangle>& stacked) {
  int sum = 0;
  for (const StackedTriangle& triangle : stacked) {
    const CGAL::Bounded_side side = triangle.side_of(place);
    if (side == CGAL::ON_BOUNDARY) return std::nullopt;
    if (side == CGAL::ON_BOUNDED_SIDE) sum += triangle.turn();
  }
  return sum;
}

}  // namespace

CGAL::Bounded_side StackedTriangle::side_of(const ExactKernel::Point_2& place) const {
  if (!CGAL::do_overlap(box_, place.bbox())) return CGAL::ON_UNBOUNDED_SIDE;
  bool on_line = false;
  for (std::size_t k = 0; k < 3; ++k) {
    const CGAL::Orientation own = CGAL::orientation(corners_[k], corners_[(k + 1) % 3], place);
    if (own == -turn_) return CGAL::ON_UNBOUNDED_SIDE;
    on_line = on_line || own == CGAL::ZERO;
  }
  return on_line ? CGAL::ON_BOUNDARY : CGAL::ON_BOUNDED_SIDE;
}

int stacked_over(const std::array<ExactKernel::Point_2, 3>& triangle,
                 const std::vector<StackedTriangle>& stacked) {
  // The first place on a curve that no side passes. Any line passes the curve twice at most.
  const auto& [a, b, c] = triangle;
  using Number = ExactKernel::FT;
  for (int k = 1;; ++k) {
    const auto place = CGAL::barycenter(a, Number(97 + k), b, Number(101 + k * k), c, Number(103));
    if (const auto sum = stacked_at(place, stacked)) return *sum;
  }
}

}  // namespace spm::baker
