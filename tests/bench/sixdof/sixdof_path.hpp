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
  double min_depth = 1e-4;  ///< m: the depth of the deepest tool sample varies between these
  double max_depth = 6e-4;
};

/// Poses of a tool that is pressed lightly against an object and slides over it in strokes. Each
/// stroke begins at another place on both, with another rotation. The same arguments give the same
/// path. `samples` belong to the tool; `object` is a `sparse` field that does not move.
[[nodiscard]] std::vector<Eigen::Isometry3d> press_and_slide(const SurfaceSamples& samples,
                                                             const AssetView& object,
                                                             const SurfaceSamples& object_samples,
                                                             const PathPlan& plan);

/// The same path, moved into the object so that about `share` of the tool's samples touch it in
/// the mean: a deep, wide contact.
[[nodiscard]] std::vector<Eigen::Isometry3d> pressed_in(const std::vector<Eigen::Isometry3d>& path,
                                                        const SurfaceSamples& samples,
                                                        const AssetView& object, double share);

}  // namespace spm::bench
