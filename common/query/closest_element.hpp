// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <limits>

#include "common/asset/asset_view.hpp"
#include "common/query/side_votes.hpp"
#include "common/surface/closest_on_tile.hpp"
#include "common/surface/tile.hpp"

namespace spm {

/// Elements within so many tolerances of the nearest may tell the side; see SideVotes.
inline constexpr double tie_tolerances = 1;
/// Triangles whose closest points are no farther apart share one, or no farther than their corners'
/// step.
inline constexpr double rounding_tolerances = 0.01;

/// A closest point whose own normal meets the point within this cosine faces it: see
/// ElementReading::facing.
inline constexpr double facing_cosine = 0.998;

/// How much farther than the nearest point one that faces the point may be and count, in
/// tolerances.
inline constexpr double facing_tolerances = 0.7;

/// The point of one element of a `sparse` asset that is closest to a query point.
struct ElementClosestPoint {
  double distance = std::numeric_limits<double>::infinity();  ///< m
  const Tile* tile = nullptr;                                 ///< null: on a triangle
  TileClosestPoint on_tile;
  Vector3 on_triangle = Vector3::Zero(), triangle_normal = Vector3::Zero();
  double along_normal = 0;  ///< how much of the distance is along the closest point's own normal, m
};

/// The result of a search among the elements, before the side of the point is decided.
struct ElementReading {
  ElementReading(double tie, double rounding) noexcept : sides(tie, rounding) {}

  ElementClosestPoint nearest;  ///< its distance is infinite where there is none
  /// The nearest point whose own normal meets the point, if one is so near that the surface's own
  /// error may have put it behind `nearest`: then that is the border of a patch, whose direction
  /// means nothing.
  ElementClosestPoint facing;
  std::uint32_t visited = 0;  ///< elements or parts of them that were looked at
  SideVotes sides;            ///< filled only where the place does not tell the side
};

/// A corner of the fallback's triangles, m; false where there is no such corner.
[[nodiscard]] bool stored_corner(const AssetView& asset, std::size_t which,
                                 Vector3& corner) noexcept;
/// All three of a triangle of a `full` asset; false where there is no such triangle.
[[nodiscard]] bool triangle_corners(const AssetView& asset, std::size_t triangle,
                                    std::array<Vector3, 3>& corners) noexcept;

/// Finds the element nearest to a point that lies in a place of this kind: told, inside or outside.
/// Exact where the nearest is in the band; deeper, it is at most a quarter farther than the
/// nearest. Beyond the margin outside it may find none.
[[nodiscard]] ElementReading read_elements(const AssetView& asset, const Vector3& point,
                                           CubeKind place) noexcept;

/// The same among the elements of a list that was found for the point, in a place that is told.
[[nodiscard]] ElementReading read_elements(const AssetView& asset, const IndexList& list,
                                           const Vector3& point) noexcept;

/// The signed distance that a reading comes to by what elements vote, m, finite where it found
/// one. Where votes for the two sides are close and the surface no farther than the tolerance, it
/// is less than the distance by up to 0.55 tolerances: so that close to the surface it goes through
/// 0, and not from one side's to the other's, where the votes change places, and is off by less if
/// they are wrong.
[[nodiscard]] double signed_distance(const AssetView& asset,
                                     const ElementReading& reading) noexcept;

}  // namespace spm
