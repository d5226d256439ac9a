// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <cstddef>

#include "common/base/vector.hpp"

namespace spm::baker {

/// From the middle of a cube towards an octant (bit 0: upper half in x, 1: y, 2: z): each
/// coordinate 1 or -1, so that its middle is a quarter of the cube's edge times this away.
[[nodiscard]] inline Vector3 octant_direction(std::size_t octant) {
  return {(octant & 1U) != 0 ? 1.0 : -1.0, (octant & 2U) != 0 ? 1.0 : -1.0,
          (octant & 4U) != 0 ? 1.0 : -1.0};
}

}  // namespace spm::baker
