// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>

#include "common/asset/asset_view.hpp"

namespace spm {

/// Smoothing while the loop runs: O(k) for a kernel of k samples (section 5.1), beside the one of
/// the bake, which costs nothing then.
struct RuntimeSmoothing {
  double sigma = 0;           ///< m, of the Gaussian; 0: off
  std::uint32_t samples = 7;  ///< of the kernel, 1 to most_smoothing_samples
};

inline constexpr std::uint32_t most_smoothing_samples = 64;

/// The smoothed field at a place.
struct SmoothedAnswer {
  bool known = false;                  ///< some of the kernel's samples were answered
  bool deep = false;                   ///< the place itself lies deeper than the band
  double distance = 0;                 ///< signed, m: mean of the samples' by their weight
  Vector3 gradient = Vector3::Zero();  ///< the mean of the normals, at most 1 long
};

/// The signed distance as eq. 16 smooths a map, but in space: the mean over a fixed set of places
/// about the point, spread like the Gaussian's weight. The gradient is the mean of the samples'
/// normals: that of the mean distance only where each normal is its own distance's gradient, which
/// where two patches of a field meet it is not (PotentialLattice is for that). Samples beyond the
/// band count for the nearest value that is known of them. Point in the asset's frame, m.
[[nodiscard]] SmoothedAnswer smoothed_query(const AssetView& asset,
                                            const RuntimeSmoothing& smoothing,
                                            const Vector3& point) noexcept;

}  // namespace spm
