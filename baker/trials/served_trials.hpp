// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <cstdint>
#include <vector>

#include "baker/cast/cast.hpp"
#include "common/asset/asset_view.hpp"

namespace spm::baker {

/// What trials of the served answers found.
struct ServedTrials {
  std::uint64_t count = 0;       ///< places in the band
  std::uint64_t unanswered = 0;  ///< left without an answer
  std::uint64_t beyond = 0;      ///< off by more than the tolerance
  double largest = 0;            ///< error, m, of the answered ones
  Vector3 worst =
      Vector3::Zero();  ///< a place without an answer, or else that of the largest error

  [[nodiscard]] bool passed() const noexcept { return unanswered == 0 && beyond == 0; }
};

/// Queries places all over the band, as whoever opens the file does, and compares with the surface.
/// Places that were pruned are left out.
[[nodiscard]] ServedTrials try_served(const AssetView& view, const Caster& caster,
                                      std::uint64_t seed);

}  // namespace spm::baker
