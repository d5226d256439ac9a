// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <CGAL/Exact_predicates_inexact_constructions_kernel.h>

#include <array>
#include <cstddef>
#include <cstdint>
#include <map>
#include <set>
#include <span>
#include <utility>
#include <vector>

#include "baker/base/groups.hpp"
#include "baker/mesh/mesh.hpp"
#include "baker/mesh/triangle_fan.hpp"
#include "baker/surface/self_intersection.hpp"

namespace spm::baker {

/// Of places as they are given, where nothing is constructed.
using PlainKernel = CGAL::Exact_predicates_inexact_constructions_kernel;

/// The plane of a triangle, seen along the axis that is closest to its normal. It keeps the
/// triangle's orientation.
class Projection {
 public:
  explicit Projection(const std::array<ExactKernel::Point_3, 3>& corners) : origin_(corners[0]) {
    const ExactKernel::Vector_3 normal =
        CGAL::cross_product(corners[1] - corners[0], corners[2] - corners[0]);
    drop_ = 0;
    for (int axis = 1; axis < 3; ++axis) {
      if (CGAL::abs(normal[axis]) > CGAL::abs(normal[drop_])) drop_ = axis;
    }
    first_ = (drop_ + 1) % 3;
    second_ = (drop_ + 2) % 3;
    if (normal[drop_] < 0) std::swap(first_, second_);
    slope_first_ = -normal[first_] / normal[drop_];
    slope_second_ = -normal[second_] / normal[drop_];
  }

  [[nodiscard]] ExactKernel::Point_2 down(const ExactKernel::Point_3& p) const {
    return {p[first_], p[second_]};
  }

  /// The same of a place as it is given.
  [[nodiscard]] PlainKernel::Point_2 down(const Vector3& p) const {
    return {p[first_], p[second_]};
  }

  /// The point of the plane over q.
  [[nodiscard]] ExactKernel::Point_3 up(const ExactKernel::Point_2& q) const {
    std::array<ExactKernel::FT, 3> p;
    p[static_cast<std::size_t>(first_)] = q.x();
    p[static_cast<std::size_t>(second_)] = q.y();
    p[static_cast<std::size_t>(drop_)] = height(q);
    return {p[0], p[1], p[2]};
  }

 private:
  [[nodiscard]] ExactKernel::FT height(const ExactKernel::Point_2& q) const {
    return origin_[drop_] + slope_first_ * (q.x() - origin_[first_]) +
           slope_second_ * (q.y() - origin_[second_]);
  }

  ExactKernel::Point_3 origin_;
  int drop_ = 0, first_ = 0, second_ = 0;
  ExactKernel::FT slope_first_, slope_second_;
};

/// Sides by their ends, the lower first.
using Sides = std::set<std::pair<std::uint32_t, std::uint32_t>>;

/// The traces of other triangles on one, or on some of one plane, as they are seen along the
/// projection of the first.
struct Cuts {
  explicit Cuts(const std::array<ExactKernel::Point_3, 3>& corners)
      : projection(corners), flat({down(corners[0]), down(corners[1]), down(corners[2])}) {}

  [[nodiscard]] ExactKernel::Point_2 down(const ExactKernel::Point_3& point) const {
    return projection.down(point);
  }

  Projection projection;
  std::array<ExactKernel::Point_2, 3> flat;  ///< the first one's corners
  std::vector<ExactKernel::Point_2> points;
  std::vector<std::pair<ExactKernel::Point_2, ExactKernel::Point_2>> segments;
  Sides sides;                       ///< of others in its plane, for sheets
  std::set<std::uint32_t> touching;  ///< corners of others that touch them
  Sides edges;                       ///< the same, as a whole
};

/// Along what each of some triangles is cut, by exact constructions. The first `solids` are those
/// of solids; of these, such as lie on each other in one plane are cut as one. Sheets cut no
/// others.
class TriangleCuts {
 public:
  TriangleCuts(std::span<const Vector3> points, std::span<const Triangle> triangles,
               std::size_t solids)
      : points_(points), triangles_(triangles), solids_(solids), planes_(triangles.size()) {}

  /// Cuts the triangles of pairs along what they share.
  void intersect(std::span<const TrianglePair> pairs);
  /// Cuts a triangle along a segment, as seen along the axis that is closest to its normal. A
  /// triangle that rounding left on a line is not cut.
  void cut(std::uint32_t index, const std::array<Vector3, 2>& segment);

  [[nodiscard]] bool empty() const { return cuts_.empty(); }
  /// Nothing where it is not cut, or with another before it.
  [[nodiscard]] const Cuts* of(std::uint32_t index) const {
    const auto found = cuts_.find(index);
    return found != cuts_.end() ? &found->second : nullptr;
  }
  /// The first of those that a triangle is cut with.
  [[nodiscard]] std::uint32_t plane_of(std::uint32_t index) { return planes_.of(index); }
  /// Whether a side lies between two that are cut as one, and nothing else has it.
  [[nodiscard]] bool is_inner(std::uint32_t from, std::uint32_t to) const {
    return inner_.contains(std::minmax(from, to));
  }

 private:
  std::span<const Vector3> points_;
  std::span<const Triangle> triangles_;
  std::size_t solids_;
  Groups planes_;  ///< of triangles that are cut as one
  Sides inner_;
  std::map<std::uint32_t, Cuts> cuts_;  ///< by the first

  Cuts& cuts_of(std::uint32_t index);
  [[nodiscard]] std::array<ExactKernel::Point_3, 3> corners(std::uint32_t index) const;
  [[nodiscard]] ExactKernel::Triangle_3 triangle(std::uint32_t index) const;
  [[nodiscard]] ExactKernel::Segment_3 segment(const std::array<std::uint32_t, 2>& ends) const;
  [[nodiscard]] std::array<CGAL::Orientation, 3> beside_plane(std::uint32_t plane,
                                                              std::uint32_t other) const;
  [[nodiscard]] bool in_one_plane(std::uint32_t first, std::uint32_t second) const;
  [[nodiscard]] std::vector<std::uint32_t> corners_in_plane(std::uint32_t plane,
                                                            std::uint32_t other) const;
  void find_inner_sides();
  void cut_solids(std::uint32_t first, std::uint32_t second);
  bool cut_where_touched(std::uint32_t index, std::uint32_t plane);
  void cut_at_corner(std::uint32_t corner, std::uint32_t plane);
  bool cut_along_side(std::uint32_t index, const std::array<std::uint32_t, 2>& side,
                      std::uint32_t plane);
  void cut_sheet(std::uint32_t sheet, std::uint32_t solid);
  void cut_once(std::uint32_t sheet, std::uint32_t from, std::uint32_t to);
};

}  // namespace spm::baker
