// SPDX-License-Identifier: GPL-3.0-or-later
#include "baker/verify/direction_error.hpp"

#include <algorithm>
#include <cmath>

#include "baker/verify/outcome.hpp"

namespace spm::baker {

DirectionError direction_error(const ExactSurface& surface, const ExactPlace& place,
                               double tolerance, const Answer& answer) {
  DirectionError error;
  const Vector3 truth = place.closest.position - place.point;
  error.contested = std::min(truth.norm(), std::abs(place.distance)) < min_distance_of_direction;
  if (error.contested) return error;
  // Of a sheet there is no inside.
  const bool inside = !place.closest.sheet && place.distance <= 0;
  const Vector3 toward = inside ? answer.normal : Vector3(-answer.normal);
  const Rivals rivals = surface.rivals(place.point, place.closest, 2 * tolerance, toward);
  error.contested = rivals.contested;
  if (answer.normal.squaredNorm() == 0) return error;
  error.angle =
      rivals.contested ? rivals.angle : std::atan2(toward.cross(truth).norm(), toward.dot(truth));
  return error;
}

}  // namespace spm::baker
