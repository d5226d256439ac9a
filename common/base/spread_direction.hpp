// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <numbers>

#include "common/base/vector.hpp"

namespace spm {

/// One of many unit vectors that are spread evenly on the sphere, by the golden angle. `number`:
/// below `of`. Doubles.
[[nodiscard]] inline Vector3 spread_direction(std::size_t number, std::size_t of) noexcept {
  const double z = 1 - (2 * static_cast<double>(number) + 1) / static_cast<double>(of);
  const double flat = std::sqrt(std::max(0.0, 1 - z * z));
  const double turn = std::numbers::pi * (3 - std::sqrt(5.0)) * static_cast<double>(number);
  return {flat * std::cos(turn), flat * std::sin(turn), z};
}

}  // namespace spm
