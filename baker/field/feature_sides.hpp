// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <span>
#include <vector>

#include "baker/cast/cast.hpp"
#include "baker/surface/outer_surface.hpp"
#include "common/field/feature_sides.hpp"

namespace spm::baker {

/// What tells the side of places beside a surface.
struct AskedSolid {
  const Caster& solid;
  const Caster& surface;    ///< over the surface itself
  double tolerance = 0;     ///< m: asked so far from the surface, or less where something is nearer
  double displacement = 0;  ///< m: between the surface and that of the solid
  double thin = 0;  ///< m: the normal of a triangle that is no higher than this means nothing
  std::span<const double>
      moved{};  ///< m, by triangle: so much more is it from the solid's; or none
};

/// For each triangle of a surface, what tells the side of places that are nearest to one of its
/// parts: by_crossings where the solid is not the same all around, or not to be asked.
[[nodiscard]] std::vector<FeatureSides> find_feature_sides(const OuterSurface& surface,
                                                           const AskedSolid& asked);

/// For each triangle of a surface whether another one lies on it and faces the other way.
[[nodiscard]] std::vector<bool> find_folded(const std::vector<Triangle>& triangles);

}  // namespace spm::baker
