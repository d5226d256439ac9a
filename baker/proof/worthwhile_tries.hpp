// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <algorithm>
#include <cmath>

namespace spm::baker {

/// How many tries a proof is worth, as a share of the largest number: 1, or less where the bound is
/// so small against the diagonal that most tries would be in vain. Both in metres.
[[nodiscard]] inline double worthwhile_tries(double bound, double diagonal) {
  constexpr double small_bound_share = 1e-4;
  return std::min(1.0, std::pow(bound / (small_bound_share * diagonal), 2));
}

}  // namespace spm::baker
