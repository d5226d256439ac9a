// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <Eigen/Core>

#include "common/base/vector.hpp"

namespace spm::baker {

/// A quadratic function about a place, along the axes of space: value (m), gradient and second
/// derivatives.
struct Quadratic {
  Vector3 middle = Vector3::Zero();
  double value = 0;
  Vector3 gradient = Vector3::Zero();
  Eigen::Matrix3d bend = Eigen::Matrix3d::Zero();  ///< value + gradient d + d' bend d

  [[nodiscard]] double at(const Vector3& point) const {
    const Vector3 d = point - middle;
    return value + d.dot(gradient + bend * d);
  }
  [[nodiscard]] Quadratic about(const Vector3& point) const {
    return {point, at(point), gradient + 2 * (bend * (point - middle)), bend};
  }
  [[nodiscard]] Quadratic times(double sign) const {
    return {middle, sign * value, sign * gradient, sign * bend};
  }
};

/// A field over a cube: within `off`, m, of a quadratic function.
struct FieldBound {
  Quadratic near;
  double off = 0;
  Vector3 normal = Vector3::Zero();  ///< of length 1: n_S in the middle
  double turn = 0;                   ///< n_S of length 1 is no farther from it in all the cube

  /// Over the cube with edges of twice `half`, m: how far the field is from the linear part of the
  /// quadratic at the most, and from its value in the middle.
  [[nodiscard]] double bent(double half) const {
    return half * half * near.bend.cwiseAbs().sum() + off;
  }
  [[nodiscard]] double reach(double half) const {
    return half * near.gradient.lpNorm<1>() + bent(half);
  }
};

/// A signed distance as an asset tells it, bounded over cubes.
class BoundedField {
 public:
  virtual ~BoundedField() = default;
  /// Over the cube about `middle` with edges of twice `half`, m. The value at the middle is exact
  /// but for rounding.
  [[nodiscard]] virtual FieldBound about(const Vector3& middle, double half) const = 0;
};

}  // namespace spm::baker
