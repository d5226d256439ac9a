// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <algorithm>
#include <cmath>
#include <cstdint>

#include "common/base/vector.hpp"

namespace spm {

/// Packs a unit vector into 30 bits by the octahedral map, 15 bits per axis (error below 0.01 deg).
[[nodiscard]] inline std::uint32_t pack_octahedral(const Vector3& direction) noexcept {
  const double sum = std::abs(direction.x()) + std::abs(direction.y()) + std::abs(direction.z());
  double a = direction.x() / sum;
  double b = direction.y() / sum;
  if (direction.z() < 0) {
    const double folded = (1 - std::abs(b)) * (a < 0 ? -1.0 : 1.0);
    b = (1 - std::abs(a)) * (b < 0 ? -1.0 : 1.0);
    a = folded;
  }
  const auto quantise = [](double x) {
    return static_cast<std::uint32_t>(std::lround(std::clamp((x + 1) / 2, 0.0, 1.0) * 32767.0));
  };
  return quantise(a) | (quantise(b) << 15U);
}

/// Inverse of pack_octahedral. Any 30 bits give a unit vector.
[[nodiscard]] inline Vector3 unpack_octahedral(std::uint32_t bits) noexcept {
  double a = (bits & 32767U) / 32767.0 * 2 - 1;
  double b = ((bits >> 15U) & 32767U) / 32767.0 * 2 - 1;
  const double c = 1 - std::abs(a) - std::abs(b);
  if (c < 0) {
    const double folded = (1 - std::abs(b)) * (a < 0 ? -1.0 : 1.0);
    b = (1 - std::abs(a)) * (b < 0 ? -1.0 : 1.0);
    a = folded;
  }
  return Vector3(a, b, c).normalized();
}

/// The sine of the angle between a unit vector and a packed one, without the latter's division and
/// root.
[[nodiscard]] inline double sine_between(double x, double y, double z,
                                         std::uint32_t bits) noexcept {
  constexpr double unit = 2 / 32767.0;
  double a = unit * (bits & 32767U) - 1;
  double b = unit * ((bits >> 15U) & 32767U) - 1;
  const double c = 1 - std::abs(a) - std::abs(b);
  if (c < 0) {
    const double folded = (1 - std::abs(b)) * (a < 0 ? -1.0 : 1.0);
    b = (1 - std::abs(a)) * (b < 0 ? -1.0 : 1.0);
    a = folded;
  }
  const double dot = a * x + b * y + c * z;
  return std::sqrt(std::max(0.0, 1 - dot * dot / (a * a + b * b + c * c)));
}

}  // namespace spm
