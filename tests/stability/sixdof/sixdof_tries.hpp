// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <cstdint>

#include "tests/stability/sixdof/sixdof_laboratory.hpp"

namespace spm::stability {

/// What became of many tries to pull a turned tool through a plate.
struct PlateTries {
  int tries = 0;
  int passed = 0;      ///< the drawn tool got behind the plate, or deeper into it than it is thick
  double deepest = 0;  ///< m, the drawn tool's deepest vertex below the plate's upper side
  std::uint64_t worst = 0;  ///< the seed of the try that went deepest
};

/// Pulls the tool of `tool-pulled-through-plate`, turned at random, from above the plate to behind
/// it at `speed` (m/s), as a hand that nothing holds back does: its reading goes straight through.
/// `first_seed` and those after it give the turns and the way. A pass is what the drawn tool does.
[[nodiscard]] PlateTries try_plate(const Contender& contender, const RunSettings& settings,
                                   double speed, int tries, std::uint64_t first_seed = 1);

}  // namespace spm::stability
