// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <functional>
#include <optional>

#include "baker/cast/cast.hpp"
#include "baker/pictures/picture.hpp"
#include "baker/verify/exact_surface.hpp"
#include "common/contour/contour_mesh.hpp"

namespace spm::baker {

/// A square window on a scene, seen along one direction without perspective.
struct Window {
  Vector3 middle = Vector3::Zero();   ///< of the visible part, m
  Vector3 toward = Vector3::UnitZ();  ///< unit, from the visible part to the eye
  double edge = 0;                    ///< m
};

/// The window that shows all of a box.
[[nodiscard]] Window whole_of(const Vector3& low, const Vector3& high, const Vector3& toward);

/// A surface in grey, lit from the upper left; dark grey where there is none. `side` in pixels.
[[nodiscard]] Picture render(const Caster& surface, const Window& window, std::uint32_t side);

/// A caster over the surface as an asset holds it.
[[nodiscard]] Caster caster_of(const ContourMesh& surface);

/// The colour of a place, m; empty where there is nothing to tell.
using ColourAt = std::function<std::optional<Colour>(const Vector3& place)>;
/// The same of a place of a surface, with the outward unit normal there.
using SurfaceColourAt =
    std::function<std::optional<Colour>(const Vector3& place, const Vector3& normal)>;

/// A surface in colours, lit as by render. Dark grey where there is no surface or nothing to tell.
[[nodiscard]] Picture coloured_surface(const Caster& surface, const Window& window,
                                       std::uint32_t side, const SurfaceColourAt& colour_at);

/// A cut across the window's middle, in colours. The exact surface is white. Dark grey where there
/// is nothing to tell.
[[nodiscard]] Picture coloured_section(const ExactSurface& exact, const Window& window,
                                       std::uint32_t side, const ColourAt& colour_at);

/// Dark blue for no error, pale yellow for the largest that is allowed, red for more.
[[nodiscard]] Colour colour_of_error(double error, double allowed);

/// What error pictures are coloured by.
struct ErrorScale {
  const ExactSurface& exact;
  const AssetView& asset;
  Band band;             ///< the band that is judged
  double tolerance = 0;  ///< m, the end of colour_of_error
};

/// The largest error of the asset's distance, m, at three places about one of the surface: there, a
/// tolerance above it and a tolerance below it. Empty where there is no answer.
[[nodiscard]] std::optional<double> largest_error_at(const ErrorScale& scale, const Vector3& place,
                                                     const Vector3& normal);

/// The surface, coloured by the largest error of the asset's distance at three places: on the
/// surface, a tolerance above it and a tolerance below it. Dark grey where there is no surface or
/// no answer.
[[nodiscard]] Picture error_on_surface(const Caster& surface, const ErrorScale& scale,
                                       const Window& window, std::uint32_t side);

/// A cut through the band across the window's middle, which shows the error of the asset's distance
/// at each place. The exact surface is white. Dark grey outside the band.
[[nodiscard]] Picture error_in_section(const ErrorScale& scale, const Window& window,
                                       std::uint32_t side);

}  // namespace spm::baker
