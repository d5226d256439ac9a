// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <cstddef>

#include "common/base/half_space.hpp"

namespace spm {

/// Up to three half-spaces that a place has to be in, m.
struct HalfSpaces {
  std::array<HalfSpace, 3> planes;
  std::size_t count = 0;

  /// False where there is no room.
  bool add(const HalfSpace& plane) noexcept {
    if (count == planes.size()) return false;
    planes[count++] = plane;
    return true;
  }
};

/// The place nearest to `point` (m) that lies in all half-spaces: what a god-object's constraints
/// leave it (Zilles and Salisbury 1995). Where normals are so alike that no such place is near, one
/// that lies in as many as can be.
[[nodiscard]] Vector3 nearest_in_planes(const HalfSpaces& spaces, const Vector3& point) noexcept;

}  // namespace spm
