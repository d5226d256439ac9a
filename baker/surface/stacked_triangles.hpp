// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <array>
#include <optional>
#include <vector>

#include "baker/base/seen_along.hpp"
#include "baker/mesh/triangle_fan.hpp"

namespace spm::baker {

/// A triangle of some that lie on each other, as it is seen along their projection.
class StackedTriangle {
 public:
  explicit StackedTriangle(const std::array<ExactKernel::Point_2, 3>& corners)
      : corners_(corners), turn_(CGAL::orientation(corners[0], corners[1], corners[2])) {}

  [[nodiscard]] CGAL::Orientation turn() const { return turn_; }
  /// Where a place lies: on the triangle, beyond it, or on one of its sides.
  [[nodiscard]] CGAL::Bounded_side side_of(const ExactKernel::Point_2& place) const;

 private:
  std::array<ExactKernel::Point_2, 3> corners_;
  CGAL::Orientation turn_;
};

/// Some that lie on each other.
class Stack {
 public:
  explicit Stack(const std::vector<std::array<ExactKernel::Point_2, 3>>& triangles);

  /// How many of these turn as they are seen, less those that turn the other way, over a triangle
  /// that no side of them passes.
  [[nodiscard]] int over(const std::array<ExactKernel::Point_2, 3>& triangle) const;

 private:
  [[nodiscard]] std::optional<int> at(const ExactKernel::Point_2& place) const;

  std::vector<StackedTriangle> triangles_;
  SeenAlong seen_;
};

}  // namespace spm::baker
