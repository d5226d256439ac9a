// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>

#include "common/asset_view.hpp"
#include "common/grid_list.hpp"
#include "common/side_claims.hpp"
#include "common/tile.hpp"

namespace spm {

enum class Status : std::uint8_t {
  exact,  ///< in the band
  deep,  ///< inside, beyond the band: distance is -max_depth, a bound; the normal is the best known
  far,   ///< outside, beyond the margin: distance NaN, normal zero
  pruned,  ///< in a place the bake left out: distance NaN, normal zero
};

enum class Source : std::uint8_t { map, triangles, none };

/// Answer of a query at a point.
struct Answer {
  double distance = 0;               ///< signed, m, negative inside
  Vector3 normal = Vector3::Zero();  ///< unit, outward
  std::int32_t plane = -1;           ///< row of the plane table, -1 for triangles
  std::int32_t layer = -1;           ///< crossing along the plane's ray, 0 the first
  Source source = Source::none;
  Status status = Status::far;
};

/// Surfaces of a list within so many tolerances of the nearest may tell the side; see SideClaims.
inline constexpr double tie_tolerances = 1;

/// What a list of a `sparse` asset says of a point, before the side is told.
struct ListReading {
  explicit ListReading(double tie) noexcept : sides(tie) {}

  const Tile* tile = nullptr;  ///< the nearest of the list's tiles, if any
  TileFoot foot;               ///< on it
  Answer triangles;            ///< of the list's triangles; its status tells whether there are any
  ListSide side = ListSide::told;  ///< of the list
  bool from_triangles = false;  ///< these are nearer than the tile
  SideClaims sides;
};

/// Reads the nearest of a list's tiles and triangles, and what is needed of others to tell the side.
/// The baker tries lists with it.
[[nodiscard]] ListReading read_list(const AssetView& asset, const GridList& list,
                                    const Vector3& point) noexcept;

/// The answer of a reading whatever the band, `far` where the list is empty.
[[nodiscard]] Answer answer_of(const AssetView& asset, const ListReading& reading) noexcept;

/// Signed distance, normal, plane and layer at a point in the asset's frame (metres): the product's
/// `spm` query. Constant time: one grid cell, its candidates, a bounded number of steps each.
/// A NaN or infinite point answers `far`. Never throws, allocates or reads outside the views.
[[nodiscard]] Answer query_point(const AssetView& asset, const Vector3& point) noexcept;

}  // namespace spm
