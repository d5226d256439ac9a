// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <cstdint>
#include <vector>

#include "baker/mesh/mesh.hpp"

namespace spm::baker {

/// A triangle of a surface that changes.
struct LooseTriangle {
  Triangle corners{};
  bool sheet = false;
  std::uint32_t parent = 0;  ///< the triangle that it is a piece of, where that is asked
};

/// Removes triangles that are thinner than `height` (m), so that no two parts of the surface that
/// belong together are so close that rounding confuses them: vertices within `height` of each other
/// become one, and where a corner lies that close to the opposite side, this side is led through
/// the corner, in all triangles that have it. What is closed stays closed, and sheets that are no
/// larger themselves stay as they are. A few may stay where this would go on in circles. Returns by
/// how much distances change at most, m.
[[nodiscard]] double remove_slivers(const std::vector<Vector3>& vertices, double height,
                                    std::vector<LooseTriangle>& triangles);

}  // namespace spm::baker
