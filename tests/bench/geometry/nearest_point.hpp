// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <cmath>
#include <limits>

#include "common/query/query.hpp"

namespace spm::bench {

/// Finds the nearest of the triangles it is shown, and the side of the solid. If several triangles
/// share the nearest place, the triangle that faces the point most directly decides the side.
class NearestPoint {
 public:
  /// `tie`: metres within which closest points count as equally near.
  NearestPoint(const Vector3& point, double tie) noexcept : point_(point), tie_(tie) {}

  /// Shows a triangle: its point closest to the place, and its corners. True where it is nearer
  /// than all before.
  bool show(const Vector3& closest_point, const Vector3& a, const Vector3& b,
            const Vector3& c) noexcept {
    const Vector3 away = point_ - closest_point;
    const double squared = away.squaredNorm();
    if (squared > bound_squared_) return false;
    // The normal is computed only for triangles that may be nearest.
    const Vector3 normal = (b - a).cross(c - a).normalized();
    const double distance = std::sqrt(squared);
    const double height = normal.dot(away);
    const double faces = distance > 0 ? std::abs(height) / distance : 1;
    if (distance < distance_ - tie_ || faces > faces_) {
      faces_ = faces;
      side_ = height < 0 ? -1 : 1;
    }
    if (distance >= distance_) return false;
    distance_ = distance;
    bound_squared_ = (distance + tie_) * (distance + tie_);
    closest_point_ = closest_point;
    normal_ = normal;
    return true;
  }

  /// In metres; infinite before the first triangle.
  [[nodiscard]] double distance() const noexcept { return distance_; }

  /// `far` if no triangle was shown.
  [[nodiscard]] Answer answer() const noexcept {
    Answer answer;
    answer.distance = std::numeric_limits<double>::quiet_NaN();
    if (!std::isfinite(distance_)) return answer;
    answer.distance = side_ * distance_;
    answer.normal =
        distance_ > tie_ ? Vector3(side_ * (point_ - closest_point_) / distance_) : normal_;
    answer.source = Source::triangles;
    answer.status = Status::exact;
    return answer;
  }

 private:
  Vector3 point_;
  double tie_;
  double distance_ = std::numeric_limits<double>::infinity();
  double bound_squared_ = std::numeric_limits<double>::infinity();
  double faces_ = -1;
  double side_ = 1;
  Vector3 closest_point_ = Vector3::Zero();
  Vector3 normal_ = Vector3::Zero();
};

}  // namespace spm::bench
