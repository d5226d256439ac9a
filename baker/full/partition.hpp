// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <cstdint>

#include "baker/base/progress.hpp"
#include "baker/cast/cast.hpp"
#include "formats/asset/asset.hpp"

namespace spm::baker {

/// What the spatial partition came to.
struct PartitionCounts {
  std::uint64_t records = 0;
  std::uint64_t fallback = 0;  ///< records with triangles
};

/// Fills `asset.grid` and `asset.triangles` of a `full` asset: for every grid cell that touches the
/// band the maps that answer its points within `tolerance`, as measured at sample points with the
/// servo's own query, or where none do the triangles that can be closest. `asset.maps` and `planes`
/// must be final.
[[nodiscard]] PartitionCounts partition_space(Asset& asset, const Caster& caster, double tolerance,
                                              std::uint64_t seed, const Progress& progress);

}  // namespace spm::baker
