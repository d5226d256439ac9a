// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "common/base/vector.hpp"

namespace spm {

/// The half-space normal . x <= offset; the normal is of unit length, the offset in its frame's
/// unit.
struct HalfSpace {
  Vector3 normal = Vector3::UnitZ();
  double offset = 0;
};

/// The half-space normal . x >= offset.
[[nodiscard]] inline HalfSpace half_space_above(const Vector3& normal, double offset) noexcept {
  return {-normal, -offset};
}

}  // namespace spm
