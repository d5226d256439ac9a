// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <cstdint>

#include "baker/verify/exact_surface.hpp"
#include "common/asset/asset_view.hpp"

namespace spm::baker {

/// A place where an asset is likeliest to be wrong: about edges and corners of the exact surface,
/// close to it all over, or beside the borders of the asset's tiles and cells. Seed and index alone
/// determine it. It lies near or in the band, up to a few tolerances or the band's depth away from
/// these features. `tolerance` in metres.
[[nodiscard]] Vector3 adversarial_place(const ExactSurface& surface, const AssetView& view,
                                        double tolerance, std::uint64_t seed, std::uint64_t index);

}  // namespace spm::baker
