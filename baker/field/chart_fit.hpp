// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <functional>
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

/// One chart, or two.
struct FittedCharts {
  MapPair pair;
  std::vector<ChartAtLevel> charts;
};

/// Whether charts that meet the samples are proven.
using ChartProof = std::function<bool(const FittedCharts&)>;

/// A chart that meets the samples of a cube and is proven: the one that faces them most first, each
/// from its coarsest spacing on; or two, for samples that are told apart by their directions. Empty
/// where none of the few that are tried is.
[[nodiscard]] std::optional<FittedCharts> find_one_chart(const std::vector<CubeSample>& samples,
                                                         const Cube& cube, const ChartRules& rules,
                                                         const ChartProof& proven);
[[nodiscard]] std::optional<FittedCharts> find_two_charts(const std::vector<CubeSample>& samples,
                                                          const Cube& cube, const ChartRules& rules,
                                                          const ChartProof& proven);

}  // namespace spm::baker
