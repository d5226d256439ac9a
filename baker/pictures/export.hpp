// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <array>
#include <cstdint>
#include <string>
#include <vector>

#include "common/asset/asset_view.hpp"

namespace spm::baker {

/// The surface as an asset holds it: loose patches, not one closed mesh.
struct KnownSurface {
  std::vector<std::array<float, 3>> vertices;           ///< metres, asset's frame
  std::vector<std::array<std::uint32_t, 3>> triangles;  ///< anticlockwise seen from outside
};

/// Eq. 4 over every valid cell of every map's layers and of every tile, two triangles a cell. A
/// clipped cell counts up to its line. The exact triangles that the partition refers to are added.
/// Maps and tiles overlap, so patches overlap too.
[[nodiscard]] KnownSurface known_surface(const AssetView& asset);

/// The surface as a PLY file's bytes: binary little endian, or text.
[[nodiscard]] std::string to_ply(const KnownSurface& surface, bool text);

}  // namespace spm::baker
