// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <CGAL/Bbox_2.h>

#include <array>
#include <vector>

#include "baker/mesh/triangle_fan.hpp"

namespace spm::baker {

/// A triangle of some that lie on each other, as it is seen along their projection.
class StackedTriangle {
 public:
  explicit StackedTriangle(const std::array<ExactKernel::Point_2, 3>& corners)
      : corners_(corners),
        turn_(CGAL::orientation(corners[0], corners[1], corners[2])),
        box_(corners[0].bbox() + corners[1].bbox() + corners[2].bbox()) {}

  [[nodiscard]] CGAL::Orientation turn() const { return turn_; }
  /// Where a place lies: on the triangle, beyond it, or on one of its sides.
  [[nodiscard]] CGAL::Bounded_side side_of(const ExactKernel::Point_2& place) const;

 private:
  std::array<ExactKernel::Point_2, 3> corners_;
  CGAL::Orientation turn_;
  CGAL::Bbox_2 box_;
};

/// How many of these turn as they are seen, less those that turn the other way, over a triangle
/// that no side of them passes.
[[nodiscard]] int stacked_over(const std::array<ExactKernel::Point_2, 3>& triangle,
                               const std::vector<StackedTriangle>& stacked);

}  // namespace spm::baker
