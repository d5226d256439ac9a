// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>

#include "common/contour/contour_mesh.hpp"

namespace spm::servo {

/// Cells along the longest edge of an asset's box, of the grid of a mesh that the page draws.
inline constexpr int picture_cells = 88;

/// The mesh as the page reads it, little endian: the number of vertices and of triangles (uint32),
/// the vertices (float32), the corners (uint32).
[[nodiscard]] std::string to_bytes(const ContourMesh& mesh);

}  // namespace spm::servo
