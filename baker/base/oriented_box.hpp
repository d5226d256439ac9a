// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <Eigen/Core>
#include <nlohmann/json_fwd.hpp>

#include "common/base/vector.hpp"

namespace spm::baker {

/// A box that may be turned; metres, in an asset's frame.
struct OrientedBox {
  Vector3 middle = Vector3::Zero();
  Eigen::Matrix3d axes =
      Eigen::Matrix3d::Identity();  ///< unit columns, the directions of its edges
  Vector3 half = Vector3::Zero();   ///< half of each edge's length

  /// The point of the box that is closest to another.
  [[nodiscard]] Vector3 closest(const Vector3& point) const {
    const Vector3 at = axes.transpose() * (point - middle);
    return middle + axes * at.cwiseMax(-half).cwiseMin(half);
  }
};

/// Whether an axis-aligned cube (middle and edge, m) may touch the box. It is always true where
/// they touch. Where it is true, they are less than the cube's diagonal apart. Edge 0 means a
/// point.
[[nodiscard]] bool may_touch(const OrientedBox& box, const Vector3& middle, double edge) noexcept;

/// Whether a point of a triangle lies in the box.
[[nodiscard]] bool touches_triangle(const OrientedBox& box, const Vector3& a, const Vector3& b,
                                    const Vector3& c);

/// The box with each face moved outwards by `distance`, metres.
[[nodiscard]] OrientedBox grown(OrientedBox box, double distance) noexcept;

/// `{middle, axes, half}`, as an asset's options record it.
[[nodiscard]] nlohmann::ordered_json to_json(const OrientedBox& box);

}  // namespace spm::baker
