// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include "baker/verify/render.hpp"

namespace spm::baker {

/// The colours of what answers at a place.
namespace structure_colours {
inline constexpr Colour one_map{0.27, 0.47, 0.75};    ///< blue: one distance map
inline constexpr Colour two_maps{0.40, 0.76, 0.62};   ///< green: the smaller or larger of two
inline constexpr Colour list{0.96, 0.76, 0.30};       ///< yellow: a list of one packet or less
inline constexpr Colour long_list{0.80, 0.30, 0.20};  ///< red: a longer list of triangles
inline constexpr Colour deep{0.26, 0.26, 0.30};       ///< grey: deeper than the band
inline constexpr Colour pruned{0.55, 0.35, 0.65};     ///< violet: left out by the bake
}  // namespace structure_colours

/// The surface, coloured by what answers there. Of a `full` asset, maps are blue and triangles
/// yellow. `side` in pixels.
[[nodiscard]] Picture structure_on_surface(const Caster& surface, const AssetView& asset,
                                           const Window& window, std::uint32_t side);

/// A cut across the window's middle, coloured by what answers there. The exact surface is white,
/// and the borders of the octree's leaves are dark.
[[nodiscard]] Picture structure_in_section(const ExactSurface& exact, const AssetView& asset,
                                           const Window& window, std::uint32_t side);

}  // namespace spm::baker
