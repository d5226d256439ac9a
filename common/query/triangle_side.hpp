// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>

#include "common/base/vector.hpp"

namespace spm {

/// The angle that a triangle takes up around the closest point on it.
struct IncidentSector {
  double angle = 0;  ///< rad: pi on a side, 2 pi in the interior
  /// The difference of the unit vectors along the triangle's borders away from the closest point:
  /// the one along its orientation minus the other; 0 in the interior. For triangles that surround
  /// a closest point completely these add up to 0.
  Vector3 borders = Vector3::Zero();
};

/// `closest_point` is the triangle's point closest to the query point; `within` is true where it is
/// on none of the triangle's sides.
[[nodiscard]] IncidentSector incident_sector(const std::array<Vector3, 3>& corners,
                                             const Vector3& closest_point, bool within) noexcept;

/// Decides on which side of a mesh a point lies, from the triangles nearest to it.
///
/// Triangles that surround the nearest closest point decide by the sum of their normals, each
/// weighted with the angle that the triangle takes up there (Baerentzen and Aanaes 2005). A
/// triangle's neighbour may be missing, because a tile replaces it or corners were rounded. Then
/// all closest points are considered that rounding may have put behind the nearest; if they belong
/// to more than one face, the one that faces the point most decides.
class TriangleSide {
 public:
  /// `rounding`: how far apart closest points may be that were one before corners were rounded, m,
  /// above 0.
  explicit TriangleSide(double rounding) noexcept : rounding_(rounding) {}

  /// Adds a triangle: its corners, its closest point and that point's distance, and the component
  /// of the distance along the triangle's normal, m, below 0 inside.
  void add(const std::array<Vector3, 3>& corners, const Vector3& closest_point, double distance,
           double along_normal) noexcept {
    const bool near = is_near(closest_point, distance);
    const bool nearer = distance < distance_;
    if (!nearer && !near) return;
    const double cosine = distance > 0 ? along_normal / distance : 0;
    const bool within = std::abs(along_normal) > within_cosine * distance;
    const IncidentSector corner = incident_sector(corners, closest_point, within);
    const bool same =
        (closest_point - closest_point_).squaredNorm() <= square(same_share * rounding_);
    if (nearer && !same) shared_ = Around{};
    if (nearer && !near) about_ = Around{};
    if (nearer) {
      distance_ = distance;
      closest_point_ = closest_point;
    }
    if (same || nearer) shared_.add(cosine, corner);
    about_.add(cosine, corner);
  }

  /// Above 0 outside, below 0 inside, 0 where the triangles do not decide.
  [[nodiscard]] double side() const noexcept {
    if (shared_.closed()) return clear(shared_.sum);
    const bool both = about_.inside > 0 && about_.outside > 0;
    return both || about_.closed() ? clear(about_.outside - about_.inside) : 0;
  }

 private:
  static constexpr double rounding_share = 0.5;
  static constexpr double same_share = 1e-3;
  static constexpr double no_border = 0.1;
  static constexpr double within_angle = 6;
  static constexpr double within_cosine = 1 - 1e-9;  ///< 1, less the rounding of numbers
  static constexpr double no_difference = 1e-6;

  /// Triangles around a closest point.
  struct Around {
    Vector3 borders = Vector3::Zero();
    double sum = 0;                  ///< of the cosines to the point, weighted by angle
    double inside = 0, outside = 0;  ///< largest cosine towards each side
    bool within = false;             ///< it lies in the interior of one of them

    void add(double cosine, const IncidentSector& corner) noexcept {
      borders += corner.borders;
      within = within || corner.angle > within_angle;
      sum += corner.angle * cosine;
      inside = std::max(inside, -cosine);
      outside = std::max(outside, cosine);
    }
    [[nodiscard]] bool closed() const noexcept { return within || borders.norm() < no_border; }
  };

  double rounding_;
  double distance_ = std::numeric_limits<double>::max();
  Vector3 closest_point_ = Vector3::Constant(std::sqrt(std::numeric_limits<double>::max()) / 2);
  Around shared_;  ///< around the nearest closest point
  Around about_;   ///< around the same point, within rounding

  /// True where rounding may have moved a closest point this far from the nearest.
  [[nodiscard]] bool is_near(const Vector3& closest_point, double distance) const noexcept {
    if (std::abs(distance - distance_) > rounding_share * rounding_) return false;
    // Sideways by as much as changes the distance by no more than that.
    return (closest_point - closest_point_).squaredNorm() <=
           rounding_ * (rounding_ + 2 * rounding_share * distance);
  }
  [[nodiscard]] static double square(double x) noexcept { return x * x; }
  /// The two faces of a sheet without thickness cancel, apart from the rounding of numbers.
  [[nodiscard]] static double clear(double side) noexcept {
    return std::abs(side) > no_difference ? side : 0;
  }
};

}  // namespace spm
