// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <cstdint>
#include <vector>

#include "baker/field/lattice_surface.hpp"
#include "formats/asset/asset.hpp"

namespace spm::baker {

inline constexpr std::uint32_t not_stored = 0xFFFFFFFF;
/// Bytes of a triangle and of a corner in the file.
inline constexpr std::uint64_t stored_triangle_bytes = 10, stored_corner_bytes = 8;

/// Writes the triangles that are used as the file stores them, such that those that are close in
/// space are close in memory. Returns the number of each in the file, or not_stored. Throws
/// BakeError where there are too many.
[[nodiscard]] std::vector<std::uint32_t> write_triangles(const LatticeSurface& surface,
                                                         const std::vector<bool>& used,
                                                         OctreeData& data);

}  // namespace spm::baker
