// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "common/sixdof/support_culling.hpp"

namespace spm::bench {

/// Objects that drift among each other, and what each kind of culling makes of their pairs.
struct CullingRow {
  std::string scene;  ///< "random" or "near": pairs a gap of up to a tenth of them apart
  std::uint64_t objects = 0;
  std::uint64_t pairs = 0;  ///< tests of pairs over all ticks
  // Pairs that each leaves to the narrow phase, of all.
  std::uint64_t after_aabb = 0, after_obb = 0, after_spm = 0;
  std::uint64_t touching = 0;                  ///< pairs whose hulls are not apart
  double aabb_ns = 0, obb_ns = 0, spm_ns = 0;  ///< a pair that came to this test, mean
  double remembered = 0;  ///< of the pairs that support planes told apart, by the last direction
};

/// Scenes of 2, 10, 100 and 1000 copies of a hull (`max_objects` at most), random and near.
/// Support planes and oriented boxes are asked of what passed the boxes along the axes.
[[nodiscard]] std::vector<CullingRow> measure_culling(const SupportHull& hull,
                                                      std::uint64_t max_objects,
                                                      std::uint64_t seed);

}  // namespace spm::bench
