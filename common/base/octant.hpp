// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <cstdint>

#include "common/base/vector.hpp"

namespace spm {

/// The octants of a cube are numbered x fastest: bit 0 is set in the upper half in x, bit 1 in y,
/// bit 2 in z.
[[nodiscard]] constexpr bool is_upper(std::size_t octant, std::size_t axis) noexcept {
  return ((octant >> axis) & 1U) != 0;
}

/// From the middle of a cube towards an octant: each coordinate 1 or -1, so that the octant's
/// middle is a quarter of the cube's edge times this away.
[[nodiscard]] inline Vector3 octant_direction(std::size_t octant) noexcept {
  return {is_upper(octant, 0) ? 1.0 : -1.0, is_upper(octant, 1) ? 1.0 : -1.0,
          is_upper(octant, 2) ? 1.0 : -1.0};
}

/// The octant of a cube that a point lies in; on the border it is the upper one.
[[nodiscard]] inline std::size_t octant_of(const Vector3& middle, const Vector3& point) noexcept {
  std::size_t octant = 0;
  for (std::size_t axis = 0; axis < 3; ++axis) {
    const auto k = static_cast<int>(axis);
    if (point[k] >= middle[k]) octant |= std::size_t{1} << axis;
  }
  return octant;
}

/// The octant of a cube that a place lies in, coordinates 0 to 1 from the cube's lowest corner;
/// makes the place one of that octant.
template <class Place>
[[nodiscard]] std::uint32_t enter_octant(Place& within) noexcept {
  std::uint32_t octant = 0;
  for (unsigned axis = 0; axis < 3; ++axis) {
    within[axis] *= 2;
    if (within[axis] < 1) continue;
    within[axis] -= 1;
    octant |= 1U << axis;
  }
  return octant;
}

}  // namespace spm
