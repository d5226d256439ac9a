// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>

#include "common/base/vector.hpp"

namespace spm {

/// How rough a surface feels; all finite.
struct TextureSettings {
  double amplitude = 0;   ///< m: no place is raised or lowered by more
  double wavelength = 0;  ///< m, above 0: places so far apart are raised independently
  std::uint64_t seed = 0;
};

/// How much a surface is raised at a place, and how that changes.
struct TextureHeight {
  double height = 0;                   ///< m, at most the amplitude either way
  Vector3 gradient = Vector3::Zero();  ///< of the height; no unit
};

/// The texture at a place of the object, m, object's frame: noise in space, so that the same place
/// feels the same however the hand comes to it, as eq. 19's noise in time does not. Values at the
/// corners of a lattice, drawn from their places and the seed, are blended smoothly to the second
/// derivative (Perlin 2002). A place that is not finite, or farther away than a lattice can count,
/// has none.
[[nodiscard]] TextureHeight texture_at(const TextureSettings& settings,
                                       const Vector3& place) noexcept;

/// The force on a point (N) that is so deep (m, below 0 outside) under a surface with this outward
/// unit normal, raised by the texture: the gradient of the energy k (depth + height)^2 / 2, so that
/// no closed path gains any; zero over the raised surface. Stiffness in N/m.
[[nodiscard]] Vector3 textured_force(double stiffness, double depth, const Vector3& normal,
                                     const TextureHeight& texture) noexcept;

}  // namespace spm
