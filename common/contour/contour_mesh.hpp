// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <cstdint>
#include <vector>

#include "common/asset/asset_view.hpp"

namespace spm {

/// A surface for the eye: closed, a corner shared by its triangles.
struct ContourMesh {
  std::vector<std::array<float, 3>> vertices;  ///< m, asset's frame
  std::vector<std::uint32_t> triangles;        ///< three a triangle, anticlockwise from outside
  double cell = 0;                             ///< m, edge of the grid
};

/// The zero set of an asset's field by dual contouring (Ju et al. 2002): a vertex in each cell of a
/// grid that the surface crosses, where the planes at its crossings meet best, so that edges stay
/// sharp, moved onto the surface. A wall that is thinner than a cell is found by stepping along the
/// grid's edges as far as the distances allow; a cell that two sheets cross has a vertex for each
/// of them. What crosses no edge of the grid, such as a thin wire, may be missing. The field is the
/// one that forces come from. It allocates, and takes a second: not for the loop.
[[nodiscard]] ContourMesh contour_mesh(const AssetView& asset, int cells);

}  // namespace spm
