// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cmath>

#include "common/base/vector.hpp"

namespace spm {

/// A unit vector across a unit one, always the same.
[[nodiscard]] inline Vector3 across(const Vector3& normal) noexcept {
  const Vector3 any = std::abs(normal.x()) < 0.6 ? Vector3::UnitX() : Vector3::UnitY();
  return normal.cross(any).normalized();
}

}  // namespace spm
