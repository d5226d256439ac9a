// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <cstdint>

#include "baker/verify/exact_surface.hpp"
#include "baker/verify/verify.hpp"
#include "common/asset/asset_view.hpp"

namespace spm::baker {

/// What jumps are looked for in.
struct JumpSetting {
  const ExactSurface& surface;
  const AssetView& view;
  Band band;             ///< the band that is judged
  double tolerance = 0;  ///< m
  std::uint64_t seed = 0;
};

/// The largest jump of a distance, m, that a tolerance allows. Each side is within the tolerance of
/// the one truth, and the two places that are asked are a little apart.
[[nodiscard]] constexpr double allowed_jump(double tolerance) noexcept {
  return 2 * tolerance + 1e-8;
}

/// Asks on both sides of the faces of the octree's leaves, `count` times, and compares. Leaves and
/// faces are drawn evenly; a place counts where both sides answer `exact`. The same for any number
/// of threads. Nothing of an asset without an octree (`full`).
[[nodiscard]] JumpReport border_jumps(const JumpSetting& setting, std::uint64_t count);

}  // namespace spm::baker
