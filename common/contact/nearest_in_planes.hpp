// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <cstddef>

#include "common/base/vector.hpp"

namespace spm {

/// A half-space that a point must lie in: normal . point >= offset; unit normal, m.
struct HalfSpace {
  Vector3 normal = Vector3::Zero();
  double offset = 0;
};

/// Up to three half-spaces.
struct HalfSpaces {
  std::array<HalfSpace, 3> planes;
  std::size_t count = 0;

  /// Adds a half-space. False where there is no room.
  bool add(const HalfSpace& plane) noexcept {
    if (count == planes.size()) return false;
    planes[count++] = plane;
    return true;
  }
};

/// The point nearest to `point` (m) that lies in all half-spaces: the place that a god-object's
/// constraints allow (Zilles and Salisbury 1995). Where the normals are so similar that no such
/// place is near, the result lies in as many half-spaces as possible.
[[nodiscard]] Vector3 nearest_in_planes(const HalfSpaces& spaces, const Vector3& point) noexcept;

}  // namespace spm
