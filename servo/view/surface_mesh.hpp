// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <cstdint>
#include <string>
#include <vector>

#include "common/asset/asset_view.hpp"

namespace spm::servo {

/// A surface for the eye: closed, a corner shared by its triangles.
struct SurfaceMesh {
  std::vector<std::array<float, 3>> vertices;  ///< m, asset's frame
  std::vector<std::uint32_t> triangles;        ///< three a triangle, anticlockwise from outside
  double cell = 0;                             ///< m, edge of the grid
};

/// Cells of the grid along the longest edge of an asset's box, for a picture.
inline constexpr int picture_cells = 88;

/// The zero set of an asset's field by dual contouring (Ju et al. 2002): a vertex in each cell of a
/// grid that the surface crosses, where the planes at its crossings meet best, so that edges stay
/// sharp. A wall that is thinner than a cell is found by stepping along the grid's edges as far as
/// the distances allow; a cell that two sheets cross has a vertex for each of them. What crosses no
/// edge of the grid, such as a thin wire, may be missing. The field is the one that forces come
/// from. It allocates, and takes a second: not for the loop.
[[nodiscard]] SurfaceMesh surface_mesh(const AssetView& asset, int cells = picture_cells);

/// The mesh as the page reads it, little endian: the number of vertices and of triangles (uint32),
/// the vertices (float32), the corners (uint32).
[[nodiscard]] std::string to_bytes(const SurfaceMesh& mesh);

}  // namespace spm::servo
