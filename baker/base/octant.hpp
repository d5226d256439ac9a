// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <cstddef>

#include "common/base/vector.hpp"

namespace spm::baker {

/// The direction from the middle of a cube to an octant (bit 0: upper half in x, 1: y, 2: z). Each
/// coordinate is 1 or -1. A quarter of the cube's edge times this leads to the octant's middle.
[[nodiscard]] inline Vector3 octant_direction(std::size_t octant) {
  return {(octant & 1U) != 0 ? 1.0 : -1.0, (octant & 2U) != 0 ? 1.0 : -1.0,
          (octant & 4U) != 0 ? 1.0 : -1.0};
}

}  // namespace spm::baker
