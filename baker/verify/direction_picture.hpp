// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include "baker/verify/render.hpp"

namespace spm::baker {

/// What direction pictures are coloured by.
struct DirectionScale {
  const ExactSurface& exact;
  const AssetView& asset;
  double tolerance = 0;  ///< m
  double end = 0;        ///< rad, the end of colour_of_error
};

/// The colour of a place that is not judged: beside a hole, beyond the band, or contested, see
/// direction_error.
inline constexpr Colour not_judged{0.62, 0.62, 0.62};

/// The surface, coloured by how far the asset's direction is off at the places that lie `offset`
/// metres outside of it, or inside where that is negative. Dark grey where the asset has no
/// direction. `side` in pixels.
[[nodiscard]] Picture direction_beside_surface(const Caster& surface, const DirectionScale& scale,
                                               double offset, const Window& window,
                                               std::uint32_t side);

}  // namespace spm::baker
