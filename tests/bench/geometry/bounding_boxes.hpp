// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <Eigen/Eigenvalues>
#include <Eigen/Geometry>
#include <cmath>
#include <vector>

#include "common/base/vector.hpp"

namespace spm::bench {

/// A box aligned with the world axes.
using AxisBox = Eigen::AlignedBox3d;

/// A box that rotates with its object, in the object's frame.
struct OrientedBoundingBox {
  Eigen::Isometry3d pose = Eigen::Isometry3d::Identity();  ///< the box's middle and axes
  Vector3 half = Vector3::Zero();
};

/// The box along the main axes of points, grown by `grown` metres.
[[nodiscard]] inline OrientedBoundingBox oriented_bounding_box(const std::vector<Vector3>& points,
                                                               double grown) {
  Vector3 mean = Vector3::Zero();
  for (const Vector3& point : points) mean += point / static_cast<double>(points.size());
  Eigen::Matrix3d spread = Eigen::Matrix3d::Zero();
  for (const Vector3& point : points) spread += (point - mean) * (point - mean).transpose();
  Eigen::Matrix3d axes = Eigen::SelfAdjointEigenSolver<Eigen::Matrix3d>(spread).eigenvectors();
  if (axes.determinant() < 0) axes.col(0) *= -1;
  AxisBox box;
  for (const Vector3& point : points) box.extend(Vector3(axes.transpose() * point));
  OrientedBoundingBox made;
  made.pose.linear() = axes;
  made.pose.translation() = axes * box.center();
  made.half = box.sizes() / 2 + Vector3::Constant(grown);
  return made;
}

/// Whether two boxes are disjoint, tested on all fifteen axes (Gottschalk et al. 1996). `pose2`
/// maps the frame of the second box (its middle and axes) to that of the first.
[[nodiscard]] inline bool boxes_apart(const Vector3& half1, const Vector3& half2,
                                      const Eigen::Isometry3d& pose2) noexcept {
  const Eigen::Matrix3d& turn = pose2.linear();
  const Vector3 off = pose2.translation();
  const Eigen::Matrix3d sizes = turn.cwiseAbs() + Eigen::Matrix3d::Constant(1e-12);
  for (int i = 0; i < 3; ++i) {
    if (std::abs(off[i]) > half1[i] + sizes.row(i).dot(half2)) return true;
    if (std::abs(turn.col(i).dot(off)) > half2[i] + sizes.col(i).dot(half1)) return true;
  }
  for (int i = 0; i < 3; ++i) {
    const int i1 = (i + 1) % 3, i2 = (i + 2) % 3;
    for (int j = 0; j < 3; ++j) {
      const int j1 = (j + 1) % 3, j2 = (j + 2) % 3;
      const double reach = half1[i1] * sizes(i2, j) + half1[i2] * sizes(i1, j) +
                           half2[j1] * sizes(i, j2) + half2[j2] * sizes(i, j1);
      if (std::abs(off[i2] * turn(i1, j) - off[i1] * turn(i2, j)) > reach) return true;
    }
  }
  return false;
}

}  // namespace spm::bench
