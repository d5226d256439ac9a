// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <Eigen/Geometry>
#include <cmath>

#include "common/sixdof/sample_vectors.hpp"
#include "common/sixdof/surface_samples.hpp"

namespace spm {

/// Upper bounds of the motion of a tool's parts from one pose to another, m.
class ToolMotion {
 public:
  ToolMotion(const Eigen::Isometry3d& from, const Eigen::Isometry3d& to) noexcept
      : turned_(to.linear() - from.linear()),
        moved_(to.translation() - from.translation()),
        // A rotation by t moves a point at distance r from the axis by 2 r sin(t / 2).
        turn_(turned_.norm() / std::sqrt(2.0) * (1 + 1e-9)) {}
  [[nodiscard]] double of(const Vector3& middle, double radius) const noexcept {
    return (turned_ * middle + moved_).norm() + turn_ * radius;
  }
  /// Of a sample and those below it.
  [[nodiscard]] double of(const SamplePlace& place) const noexcept {
    const Vector3 way = turned(turned_, place.position) + moved_;
    return way.norm() + turn_ * static_cast<double>(place.radius);
  }

 private:
  Eigen::Matrix3d turned_;
  Vector3 moved_;
  double turn_;
};

}  // namespace spm
