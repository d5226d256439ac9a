// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "common/asset/asset_view.hpp"
#include "common/sixdof/surface_samples.hpp"

namespace spm::bench {

/// A scene of drifting objects, and the result of each kind of culling on their pairs.
struct CullingRow {
  std::string scene;  ///< "random", or "near": paired, with a gap of up to 0.1 radii
  std::uint64_t objects = 0;
  std::uint64_t pairs = 0;  ///< number of pair tests over all ticks
  // Of these, the number of pairs that each kind of culling leaves to the narrow phase.
  std::uint64_t after_aabb = 0, after_obb = 0, after_spm = 0;
  std::uint64_t touching = 0;                  ///< pairs whose hulls are not apart
  double aabb_ns = 0, obb_ns = 0, spm_ns = 0;  ///< mean per pair given to this test
  double remembered = 0;  ///< share of the pairs culled by spm that the last plane separated
};

/// Of scenes of copies of one baked object.
struct CullingReport {
  std::uint64_t hull_points = 0;  ///< of its convex hull, of which the boxes are made
  std::vector<CullingRow> rows;
};

/// Scenes of 2, 10, 100 and 1000 copies (`max_objects` at most), random and near. Support planes
/// and oriented boxes test only the pairs that the axis-aligned boxes leave. Support planes are
/// tested as a tick does: one object's of its baked file, against the hull of the other's
/// `samples`.
[[nodiscard]] CullingReport measure_culling(const AssetView& object, const SurfaceSamples& samples,
                                            std::uint64_t max_objects, std::uint64_t seed);

}  // namespace spm::bench
