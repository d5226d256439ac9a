// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <Eigen/Geometry>
#include <cstdint>
#include <vector>

#include "common/asset/asset_view.hpp"
#include "common/sixdof/surface_samples.hpp"

namespace spm::bench {

struct PathPlan {
  std::uint64_t ticks = 5000;
  std::uint64_t seed = 1;
  double speed = 0.04;      ///< m/s along the object
  double rate = 1000;       ///< 1/s
  double min_depth = 1e-4;  ///< m: the deepest sample of the tool goes between these
  double max_depth = 6e-4;
};

/// Poses of a tool that is pressed shallowly to an object and slides over it, stroke by stroke:
/// each begins at another place of both, with another turn. Same arguments, same path. `samples`
/// are the tool's, `object` a `sparse` field that stands still.
[[nodiscard]] std::vector<Eigen::Isometry3d> press_and_slide(const SurfaceSamples& samples,
                                                             const AssetView& object,
                                                             const SurfaceSamples& object_samples,
                                                             const PathPlan& plan);

}  // namespace spm::bench
