// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <limits>

#include "common/surface/support_plane.hpp"
#include "common/surface/tile.hpp"

namespace spm {

/// Closest point of a tile's valid surface to a point.
struct TileFoot {
  float distance = std::numeric_limits<float>::infinity();  ///< m, 0 or more
  float below = 0;        ///< m: how far the point lies under the tangent plane at the foot, on the
                          ///< solid's side; negative outside
  float slope_eta = 0;    ///< dD/d eta at the foot (eq. 7)
  float slope_omega = 0;  ///< dD/d omega at the foot (eq. 8)
  float away_eta = 0, away_omega = 0, away_depth = 0;  ///< point minus foot, plane's frame, m
  std::uint32_t cell = 0;
};

/// Finds the foot if it is nearer than `limit` (m); otherwise leaves `distance` infinite. Every
/// valid cell competes: blocks of cells that provably cannot hold a nearer point are passed over,
/// in the others the cell's mean plane is met by one Newton step (eq. 7, 8), clamped to the cell,
/// and the bilinear height taken there. The distance is that of a true point of the tile, and at
/// most half the cell's twist |h00 - h10 - h01 + h11| more than the least.
[[nodiscard]] TileFoot closest_on_tile(const Tile& tile, float height_unit,
                                       const SupportPlane& plane, const Vector3& point,
                                       float limit) noexcept;

/// Lower bound of the distance of a point to the tile's valid surface, m.
[[nodiscard]] float tile_distance_bound(const Tile& tile, const SupportPlane& plane,
                                        const Vector3& point) noexcept;

}  // namespace spm
