// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "baker/mesh/mesh.hpp"

namespace spm::baker {

struct Orientation {
  std::uint32_t components = 0;  ///< parts connected by edges
  Counted inverted;              ///< patches that were inside out
  Counted flipped;               ///< triangles that disagreed with their neighbours
  Counted unorientable;          ///< edges whose two triangles cannot agree
  Counted nonmanifold_edges;     ///< edges of more than two triangles
  Counted border_edges;          ///< edges that some triangle leaves open
};

/// Orients triangles in place so that their normals point out of the solid. Neighbours across an
/// edge of two triangles are made to agree. A patch of such neighbours follows the majority of its
/// triangles. It is turned where it is inside out, and kept where it bounds a cavity of a patch
/// around it.
[[nodiscard]] Orientation orient(std::span<const Vector3> points, std::vector<Triangle>& triangles);

/// Turns parts as a whole where they are inside out, by the same rules; gives how many. `parts` are
/// their numbers, by triangle.
[[nodiscard]] Counted turn_parts(std::span<const Vector3> points,
                                 std::span<const std::uint32_t> parts,
                                 std::vector<Triangle>& triangles);

}  // namespace spm::baker
