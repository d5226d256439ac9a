// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <cmath>

#include "common/base/vector.hpp"

namespace spm {

/// Three numbers that are never loaded in pairs: those that were written one by one would stall.
struct Arm {
  double x, y, z;
  [[nodiscard]] double dot(const Arm& other) const noexcept {
    return x * other.x + y * other.y + z * other.z;
  }
  [[nodiscard]] Arm operator+(const Arm& other) const noexcept {
    return {x + other.x, y + other.y, z + other.z};
  }
};
[[nodiscard]] inline Arm arm_of(const std::array<float, 3>& v) noexcept {
  return {double{v[0]}, double{v[1]}, double{v[2]}};
}

// Element by element: a vector that is written this way and loaded in pairs would stall.
[[nodiscard]] inline Vector3 turned(const Eigen::Matrix3d& by,
                                    const std::array<float, 3>& v) noexcept {
  return by.col(0) * double{v[0]} + by.col(1) * double{v[1]} + by.col(2) * double{v[2]};
}
[[nodiscard]] inline Vector3 vector_of(const std::array<float, 3>& v) noexcept {
  return {double{v[0]}, double{v[1]}, double{v[2]}};
}
[[nodiscard]] inline std::array<float, 3> floats_of(const Vector3& v) noexcept {
  return {static_cast<float>(v.x()), static_cast<float>(v.y()), static_cast<float>(v.z())};
}
[[nodiscard]] inline double length(const std::array<float, 3>& v) noexcept {
  const double x = double{v[0]}, y = double{v[1]}, z = double{v[2]};
  return std::sqrt(x * x + y * y + z * z);
}

}  // namespace spm
