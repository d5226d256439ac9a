// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <cstdint>
#include <vector>

#include "tests/stability/theory/sampled_loop.hpp"
#include "tests/stability/theory/theory_rows.hpp"

namespace spm::stability {

/// Stiffness (N/m) at which the plant neither grows nor decays after a push. It is found near
/// `guess` (N/m) from the growth of the envelope alone, without any threshold; NaN where it is not
/// within a fifth of the guess. `loop.stiffness` is not used.
[[nodiscard]] double simulated_border(const SampledLoop& loop, double guess);

/// Random loops that vary in mass, damping, virtual damping, filter, delay (whole or fractional),
/// lag and hand, each with a border between 100 N/m and 50 kN/m. The same seed gives the same
/// loops.
[[nodiscard]] std::vector<SampledLoop> drawn_loops(int count, std::uint64_t seed);

/// Compares the plant's linear border with the exact eigenvalue over `count` loops: kind
/// `stability`. Runs in parallel; the rows do not depend on it.
[[nodiscard]] std::vector<TheoryRow> validate_plant(int count, std::uint64_t seed);

/// Compares each passivity formula with its adversary on the plant: kind `passivity`; and the
/// approximate formula of stability with the exact eigenvalue: kind `approximation`. `count` rows
/// of each.
[[nodiscard]] std::vector<TheoryRow> validate_formulas(int count, std::uint64_t seed);

/// Largest and root mean square deviation of the rows, as shares.
struct TheoryErrors {
  double largest = 0, rms = 0;
};
[[nodiscard]] TheoryErrors errors_of(const std::vector<TheoryRow>& rows);

}  // namespace spm::stability
