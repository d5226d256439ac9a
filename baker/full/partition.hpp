// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <cstdint>

#include "baker/base/progress.hpp"
#include "baker/cast/cast.hpp"
#include "formats/asset/asset.hpp"

namespace spm::baker {

/// Counts of the spatial partition.
struct PartitionCounts {
  std::uint64_t records = 0;
  std::uint64_t fallback = 0;  ///< records with triangles
};

/// Fills `asset.grid` and `asset.triangles` of a `full` asset. For every grid cell that touches the
/// band, the grid lists the maps that answer its points within `tolerance` (m), as measured at
/// sample points with the query that the servo uses. Where no maps do, it lists the triangles that
/// can be closest. `asset.maps` and `planes` must be final.
[[nodiscard]] PartitionCounts partition_space(Asset& asset, const Caster& caster, double tolerance,
                                              const Progress& progress);

}  // namespace spm::baker
