// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>

#include "common/asset/asset_view.hpp"

namespace spm {

/// Smoothing while the loop runs: O(k) for a kernel of k samples (section 5.1). The baker can also
/// smooth an asset, which costs nothing at run time.
struct RuntimeSmoothing {
  double sigma = 0;           ///< m, of the Gaussian; 0: off
  std::uint32_t samples = 7;  ///< of the kernel, 1 to max_smoothing_samples
};

inline constexpr std::uint32_t max_smoothing_samples = 64;

/// The smoothed field at a point.
struct SmoothedAnswer {
  bool known = false;                  ///< at least one of the kernel's samples was answered
  bool deep = false;                   ///< the point itself lies deeper than the band
  double distance = 0;                 ///< signed, m: weighted mean over the samples
  Vector3 gradient = Vector3::Zero();  ///< the mean of the normals; its length is at most 1
};

/// The signed distance, smoothed as eq. 16 smooths a map, but in space: the mean over a fixed set
/// of points around `point`, distributed like the Gaussian's weight. The gradient is the mean of
/// the samples' normals. That equals the gradient of the mean distance only where each normal is
/// the gradient of its own distance. Where two patches of a field meet it is not; PotentialLattice
/// solves that. A sample beyond the band counts with the nearest value that is known of it. Point
/// in the asset's frame, m.
[[nodiscard]] SmoothedAnswer smoothed_query(const AssetView& asset,
                                            const RuntimeSmoothing& smoothing,
                                            const Vector3& point) noexcept;

}  // namespace spm
