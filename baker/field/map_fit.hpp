// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <cstdint>
#include <optional>
#include <span>
#include <vector>

#include "baker/field/cube_samples.hpp"
#include "common/asset/asset_view.hpp"
#include "common/field/distance_octree.hpp"
#include "common/field/local_map.hpp"

namespace spm::baker {

/// What a fit is asked for.
struct FitRules {
  std::span<const SupportPlane> planes;
  Band band;
  double value_unit = 1;      ///< as DistanceOctree, m
  double max_error = 0;       ///< m, at the samples in the band
  double max_mean_angle = 0;  ///< rad, between directions, in the mean over these samples
};

/// One polynomial or two, packed as the file will have them, and as they read back.
struct FittedMaps {
  OctreeKind kind = OctreeKind::polynomial;
  std::vector<PackedLocalMap> packed;
  std::vector<LocalMap> maps;
};

/// The least-squares fit of one polynomial, or else of two that are told apart by their directions.
/// Empty where the samples are not met. Proves nothing.
[[nodiscard]] std::optional<FittedMaps> fit_one(const std::vector<CubeSample>& samples,
                                                const Cube& cube, const FitRules& rules);
[[nodiscard]] std::optional<FittedMaps> fit_two(const std::vector<CubeSample>& samples,
                                                const Cube& cube, const FitRules& rules);

}  // namespace spm::baker
