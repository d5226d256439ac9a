// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <optional>
#include <vector>

#include "common/asset/asset_view.hpp"
#include "common/base/random.hpp"

namespace spm::servo {

/// A place where a probe of some radius just touches an object: the centre of the probe there, and
/// the outward normal.
struct Touch {
  Vector3 centre = Vector3::Zero();  ///< m
  Vector3 normal = Vector3::UnitZ();
};

/// Moves a point near the surface to where a probe centred there just touches the surface. Nothing
/// if the asset gives no answer, or there is no such place nearby.
[[nodiscard]] std::optional<Touch> touch_near(const AssetView& asset, double probe_radius,
                                              Vector3 point);

/// Goes from outside the asset's box along a random line until it touches the object. Nothing if
/// the line misses the object.
[[nodiscard]] std::optional<Touch> touch_from_outside(const AssetView& asset, double probe_radius,
                                                      Random& random);

/// The same along the line through a point in the box, in a direction of length 1.
[[nodiscard]] std::optional<Touch> touch_along(const AssetView& asset, double probe_radius,
                                               const Vector3& aim, const Vector3& direction);

/// How thick the object is below a touched place, m, searched down to `limit`.
[[nodiscard]] double thickness_below(const AssetView& asset, double probe_radius,
                                     const Touch& touch, double limit);

/// True if the surface that is nearest to a point `depth` below a touched place is still the
/// touched one. This holds away from edges, and in walls that are at least twice as thick.
[[nodiscard]] bool firm_below(const AssetView& asset, double probe_radius, const Touch& touch,
                              double depth);

/// The limits of a walk over a surface.
struct WalkSettings {
  double probe_radius = 0;
  double length = 0.2;      ///< m, at most
  double stride = 0.25e-3;  ///< m
  double firm_depth = 0;    ///< m, to which every place must be firm; 0: any place will do
};

/// A random walk over the surface from a touched place. Neighbours are about a stride apart, and no
/// step goes over a sharp edge or to a place that is not firm. Contains at least the start.
[[nodiscard]] std::vector<Touch> walk(const AssetView& asset, const WalkSettings& settings,
                                      const Touch& start, Random& random);

}  // namespace spm::servo
