// SPDX-License-Identifier: GPL-3.0-or-later
#include "baker/verify/direction_picture.hpp"

#include <optional>

#include "baker/verify/direction_error.hpp"
#include "common/query/query.hpp"

namespace spm::baker {

namespace {

std::optional<Colour> error_colour(const DirectionScale& scale, const Vector3& point) {
  const SurfacePoint closest = scale.exact.closest(point);
  const double truth = scale.exact.distance(point, closest);
  const Band& band = scale.asset.band;
  if (truth < -band.max_depth || truth > band.margin) return not_judged;
  const DirectionError error = direction_error(scale.exact, {point, closest, truth},
                                               scale.tolerance, query_point(scale.asset, point));
  if (error.contested) return not_judged;
  if (error.angle < 0) return std::nullopt;
  return colour_of_error(error.angle, scale.end);
}

}  // namespace

Picture direction_beside_surface(const Caster& surface, const DirectionScale& scale, double offset,
                                 const Window& window, std::uint32_t side) {
  return coloured_surface(surface, window, side, [&](const Vector3& place, const Vector3& normal) {
    return error_colour(scale, place + offset * normal);
  });
}

}  // namespace spm::baker
