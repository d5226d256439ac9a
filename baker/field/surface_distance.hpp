// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include "baker/cast/cast.hpp"
#include "baker/surface/outer_surface.hpp"

namespace spm::baker {

/// A bound, m, of how far places of a surface are from the nearest of another, solids from solids
/// and sheets from sheets. Distances of no more than `enough` are not told apart. Both surfaces
/// have triangles of the same kinds.
[[nodiscard]] double largest_distance(const OuterSurface& from, const Caster& to, double enough);

}  // namespace spm::baker
