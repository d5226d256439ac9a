// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <optional>

#include "common/query/closest_element.hpp"

namespace spm {

/// The closest points on the primitives of a list.
struct ListedClosestPoints {
  ElementClosestPoint nearest;  ///< its distance is infinite where there is none
  /// As in ElementReading, where it is another.
  std::optional<ElementClosestPoint> facing;

  /// The one whose direction is the surface's.
  [[nodiscard]] const ElementClosestPoint& faced() const noexcept {
    return facing ? *facing : nearest;
  }
};

/// Finds the primitive of a list nearest to a point of its cube, all at once; infinite where there
/// is none. In floats from the tree's origin: a distance is off by as much as those are.
[[nodiscard]] ElementClosestPoint listed_nearest(const AssetView& asset, const IndexList& list,
                                                 const Vector3& point) noexcept;

/// What the closest points are, from the primitive that was found nearest.
[[nodiscard]] ListedClosestPoints listed_closest_points(const AssetView& asset,
                                                        const IndexList& list, const Vector3& point,
                                                        const NearestPrimitive& found) noexcept;

/// The same, and the nearest that faces the point if that one does not.
[[nodiscard]] ListedClosestPoints listed_closest_points(const AssetView& asset,
                                                        const IndexList& list,
                                                        const Vector3& point) noexcept;

}  // namespace spm
