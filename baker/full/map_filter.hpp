// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <vector>

#include "baker/smooth/smooth_options.hpp"
#include "formats/asset/asset.hpp"

namespace spm::baker {

/// Filters distance maps (section 4.1): D'_SP = D_SP * G_sigma of eq. 16, layer by layer, over the
/// samples that are joined to the one that is filtered by no step steeper than a surface that a
/// map sees. With `crease` the filter keeps edges: samples count only where the surface's normal
/// (eq. 5) turns by no more than the angle from that of the filtered one. Samples that met nothing
/// stay so. Where a window is cut off, its samples' own plane counts and not their mean, so that
/// what leans stays where it is. `options` has a sigma. The same for any number of threads.
void filter_maps(std::vector<MapData>& maps, const SmoothOptions& options);

}  // namespace spm::baker
