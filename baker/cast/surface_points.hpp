// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <cstdint>
#include <vector>

#include "baker/cast/cast.hpp"

namespace spm::baker {

/// A point of the surface and the triangle it lies on.
struct SurfacePoint {
  Vector3 point;
  std::uint32_t triangle = 0;
};

/// A point at some height along the outward normal of a surface point.
struct Probe {
  Vector3 point, normal;
  double height = 0;
};

/// Points all over the surface, about `spacing` metres apart. Every triangle has points inside, as
/// many as its area needs, and along its rim, corners included. Points of the rim are moved inwards
/// by `inset` metres, and by at most a tenth of the way to the triangle's middle.
[[nodiscard]] std::vector<SurfacePoint> surface_points(const Caster& caster, double spacing,
                                                       double inset, std::uint64_t seed);

}  // namespace spm::baker
