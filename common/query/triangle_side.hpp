// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>

#include "common/base/vector.hpp"

namespace spm {

/// What a triangle takes up about its foot.
struct FootCorner {
  double angle = 0;  ///< rad: half a turn on a side, a whole one within
  /// Of the unit vectors along the triangle's borders away from the foot, the one along its
  /// orientation less the other; 0 within. Those of triangles all around a foot add up to 0.
  Vector3 borders = Vector3::Zero();
};

/// `foot` is the triangle's point closest to another, and `within` where it is on no side of it.
[[nodiscard]] FootCorner foot_corner(const std::array<Vector3, 3>& corners, const Vector3& foot,
                                     bool within) noexcept;

/// Tells on which side of a mesh a point lies, from the triangles nearest to it. Those that lie all
/// around the nearest foot tell it by the sum of their normals, each with the angle that the
/// triangle takes up there (Baerentzen and Aanaes 2005). Where a triangle's neighbour is not there,
/// because a tile stands for it or corners were rounded, of all feet that rounding may have put
/// behind the nearest the one tells that faces the point most, if they are more than one face's.
class TriangleSide {
 public:
  /// `rounding`: how far apart feet may be that were one before corners were rounded, m, above 0.
  explicit TriangleSide(double rounding) noexcept : rounding_(rounding) {}

  /// Adds a triangle: its corners, its foot and that one's distance, and how much of the distance
  /// is along the triangle's normal, m, below 0 inside.
  void add(const std::array<Vector3, 3>& corners, const Vector3& foot, double distance,
           double along_normal) noexcept {
    const bool near = is_near(foot, distance);
    const bool nearer = distance < distance_;
    if (!nearer && !near) return;
    const double cosine = distance > 0 ? along_normal / distance : 0;
    const bool within = std::abs(along_normal) > within_cosine * distance;
    const FootCorner corner = foot_corner(corners, foot, within);
    const bool same = (foot - foot_).squaredNorm() <= square(same_share * rounding_);
    if (nearer && !same) shared_ = Around{};
    if (nearer && !near) about_ = Around{};
    if (nearer) {
      distance_ = distance;
      foot_ = foot;
    }
    if (same || nearer) shared_.add(cosine, corner);
    about_.add(cosine, corner);
  }

  /// Above 0 outside, below 0 inside, 0 where the triangles do not tell.
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
  static constexpr double within_cosine = 1 - 1e-9;  ///< 1 but for rounding of numbers
  static constexpr double no_difference = 1e-6;

  /// Triangles about a foot.
  struct Around {
    Vector3 borders = Vector3::Zero();
    double sum = 0;                  ///< of how they face the point, by angle
    double inside = 0, outside = 0;  ///< how much the one that faces it most does
    bool within = false;             ///< it lies within one of them

    void add(double cosine, const FootCorner& corner) noexcept {
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
  Vector3 foot_ = Vector3::Constant(std::sqrt(std::numeric_limits<double>::max()) / 2);
  Around shared_;  ///< the foot
  Around about_;   ///< the foot, as near as rounding tells

  /// True where rounding may have put a foot as far from the nearest.
  [[nodiscard]] bool is_near(const Vector3& foot, double distance) const noexcept {
    if (std::abs(distance - distance_) > rounding_share * rounding_) return false;
    // To the side by as much as makes the distance differ by no more than that.
    return (foot - foot_).squaredNorm() <= rounding_ * (rounding_ + 2 * rounding_share * distance);
  }
  [[nodiscard]] static double square(double x) noexcept { return x * x; }
  /// The two faces of a sheet without thickness cancel but for rounding of numbers.
  [[nodiscard]] static double clear(double side) noexcept {
    return std::abs(side) > no_difference ? side : 0;
  }
};

}  // namespace spm
