// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <optional>
#include <vector>

#include "baker/charts/atlas.hpp"
#include "baker/charts/chart_heights.hpp"
#include "baker/field/cube_samples.hpp"
#include "common/asset/asset_view.hpp"
#include "common/field/distance_octree.hpp"

namespace spm::baker {

/// What charts are asked for.
struct ChartRules {
  const ChartHeights* heights = nullptr;
  Band band;
  double max_error = 0;       ///< m, at the samples in the band
  double max_mean_angle = 0;  ///< rad, between directions, in the mean over these samples
};

/// One chart, or two of which the smaller (`least`) or larger (`most`) distance counts.
struct FittedCharts {
  OctreeKind how = OctreeKind::map;
  std::vector<ChartAtLevel> charts;
};

/// The chart that faces the samples of a cube at the coarsest spacing that meets them; or two, for
/// samples that are told apart by their directions. Empty where none does. Proves nothing.
[[nodiscard]] std::optional<FittedCharts> find_one_chart(const std::vector<CubeSample>& samples,
                                                         const Cube& cube, const ChartRules& rules);
[[nodiscard]] std::optional<FittedCharts> find_two_charts(const std::vector<CubeSample>& samples,
                                                          const Cube& cube,
                                                          const ChartRules& rules);

}  // namespace spm::baker
