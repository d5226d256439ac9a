// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <cstdint>
#include <optional>
#include <span>
#include <vector>

#include "baker/field/cube_candidates.hpp"
#include "baker/field/lattice_surface.hpp"
#include "common/field/triangle_list.hpp"

namespace spm::baker {

/// A place of a cube whose side is known, and what a way from there may cross in the cube.
struct CubeSide {
  KnownPlace known;
  std::vector<std::uint32_t> passing;  ///< LatticeSurface::any_triangle
};

/// Whether places beside some part of one of these triangles are told by crossings alone.
[[nodiscard]] bool any_doubted(const LatticeSurface& surface,
                               std::span<const std::uint32_t> triangles);

/// The place is, of the cube's corners and its middle, the farthest from what may be crossed:
/// LatticeSurface::crossed where one of `solids` is doubted, or else these, which are all triangles
/// of solids that pass the cube. Nothing where all places are too close, or it is too much for a
/// list.
[[nodiscard]] std::optional<CubeSide> find_cube_side(const LatticeSurface& surface,
                                                     const Cube& cube,
                                                     std::vector<std::uint32_t> solids);

}  // namespace spm::baker
