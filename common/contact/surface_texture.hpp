// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>

#include "common/base/vector.hpp"

namespace spm {

/// Roughness of a surface; all finite.
struct TextureSettings {
  double amplitude = 0;   ///< m: largest height by which a place is raised or lowered
  double wavelength = 0;  ///< m, above 0: places this far apart are raised independently
  std::uint64_t seed = 0;
};

/// How much the texture raises a surface at a place, and the gradient of that.
struct TextureHeight {
  double height = 0;                   ///< m, at most the amplitude either way
  Vector3 gradient = Vector3::Zero();  ///< of the height; dimensionless
};

/// The texture at a place of the object, m, object's frame. It is noise in space, as that
/// of eq. 19 is on a map (map_noise), but over all of the object, and smooth. Values at the corners
/// of a lattice are derived from their positions and the seed, and are blended smoothly to the
/// second derivative (Perlin 2002). A place that is not finite, or too far away for the lattice to
/// count, has no texture.
[[nodiscard]] TextureHeight texture_at(const TextureSettings& settings,
                                       const Vector3& place) noexcept;

/// The force on a point (N) at `depth` (m, below 0 outside) under a surface with this outward unit
/// normal, raised by the texture: the gradient of the energy k (depth + height)^2 / 2, so that no
/// closed path gains energy. Zero above the raised surface. Stiffness in N/m.
[[nodiscard]] Vector3 textured_force(double stiffness, double depth, const Vector3& normal,
                                     const TextureHeight& texture) noexcept;

}  // namespace spm
