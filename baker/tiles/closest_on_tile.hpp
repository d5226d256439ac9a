// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <cstdint>
#include <limits>

#include "common/surface/support_plane.hpp"
#include "common/surface/tile.hpp"

namespace spm::baker {

/// Closest point of a tile's valid surface to a point.
struct TileClosestPoint {
  float distance = std::numeric_limits<float>::infinity();  ///< m, 0 or more
  float below = 0;      ///< m: how far the query point lies under the tangent plane at the closest
                        ///< point, towards the solid; negative outside
  float slope_eta = 0;  ///< dD/d eta at the closest point (eq. 7)
  float slope_omega = 0;  ///< dD/d omega at the closest point (eq. 8)
  float away_eta = 0, away_omega = 0,
        away_depth = 0;  ///< query point minus closest point, plane's frame, m
  std::uint32_t cell = 0;
};

/// Finds the closest point if it is nearer than `limit` (m); otherwise leaves `distance` infinite.
/// Blocks of cells that provably contain no nearer point are skipped. In every other valid cell one
/// Newton step (eq. 7, 8) finds the closest point on the cell's mean plane; it is clamped to the
/// cell, and the bilinear height is taken there. The distance is that of a true point of the tile.
/// It exceeds the least distance by at most half the cell's twist |h00 - h10 - h01 + h11|.
[[nodiscard]] TileClosestPoint closest_on_tile(const Tile& tile, float height_unit,
                                               const SupportPlane& plane, const Vector3& point,
                                               float limit) noexcept;

}  // namespace spm::baker
