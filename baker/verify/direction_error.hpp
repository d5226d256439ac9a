// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include "baker/verify/exact_surface.hpp"
#include "common/query/query.hpp"

namespace spm::baker {

/// A place and what the exact surface says of it.
struct ExactPlace {
  Vector3 point = Vector3::Zero();  ///< m
  SurfacePoint closest;
  double distance = 0;  ///< signed, m, negative inside
};

/// How far the direction of an answer is off.
struct DirectionError {
  double angle = -1;       ///< rad; negative where no direction is defined or answered
  bool contested = false;  ///< `angle` is from the nearest of the directions that compete
};

/// Compares the direction of an answer with that to the closest point. Contested are places less
/// than min_distance_of_direction from the surface, and those where another feature of it is as
/// near within two tolerances; see ExactSurface::rivals. `tolerance` in metres.
[[nodiscard]] DirectionError direction_error(const ExactSurface& surface, const ExactPlace& place,
                                             double tolerance, const Answer& answer);

}  // namespace spm::baker
