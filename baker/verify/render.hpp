// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include "baker/cast/cast.hpp"
#include "baker/pictures/export.hpp"
#include "baker/pictures/picture.hpp"
#include "baker/verify/exact_surface.hpp"

namespace spm::baker {

/// A square window on a scene, seen straight along a direction.
struct Window {
  Vector3 middle = Vector3::Zero();   ///< of what is seen, m
  Vector3 toward = Vector3::UnitZ();  ///< unit, from what is seen to the eye
  double edge = 0;                    ///< m
};

/// The window that shows all of a box.
[[nodiscard]] Window whole_of(const Vector3& low, const Vector3& high, const Vector3& toward);

/// A surface in grey, lit from the upper left; dark grey where there is none. `side` in pixels.
[[nodiscard]] Picture render(const Caster& surface, const Window& window, std::uint32_t side);

/// A caster over the surface as an asset knows it.
[[nodiscard]] Caster caster_of(const KnownSurface& surface);

/// What error pictures are coloured by.
struct ErrorScale {
  const ExactSurface& exact;
  const AssetView& asset;
  Band band;             ///< that is judged
  double tolerance = 0;  ///< m: dark blue is no error, pale yellow so much, red more
};

/// The surface coloured by the largest error of the asset's distance a tolerance above it, on it
/// and a tolerance below it. Where there is no surface, or no answer, dark grey.
[[nodiscard]] Picture error_on_surface(const Caster& surface, const ErrorScale& scale,
                                       const Window& window, std::uint32_t side);

/// A cut through the band across the window's middle: the error of the asset's distance at each
/// place, its surface white, and dark grey outside the band.
[[nodiscard]] Picture error_in_section(const ErrorScale& scale, const Window& window,
                                       std::uint32_t side);

}  // namespace spm::baker
