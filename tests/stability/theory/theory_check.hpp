// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <cstdint>
#include <vector>

#include "tests/stability/theory/sampled_loop.hpp"
#include "tests/stability/theory/theory_rows.hpp"

namespace spm::stability {

/// Stiffness (N/m) at which the plant neither grows nor decays after a push, found near `guess`
/// (N/m) by the growth of its envelope alone, without any threshold; not a number where it is not
/// within a fifth of the guess. `loop.stiffness` is not used.
[[nodiscard]] double simulated_border(const SampledLoop& loop, double guess);

/// Loops drawn over mass, damping, virtual damping, filter, delay (whole and not), lag and hand,
/// each with a border between 100 N/m and 50 kN/m. The same for the same seed.
[[nodiscard]] std::vector<SampledLoop> drawn_loops(int count, std::uint64_t seed);

/// The plant's linear border against the exact eigenvalue over `count` loops: kind `stability`. In
/// parallel; the rows do not depend on it.
[[nodiscard]] std::vector<TheoryRow> validate_plant(int count, std::uint64_t seed);

/// Each passivity formula by its adversary on the plant: kind `passivity`; and the approximate
/// formula of stability against the exact eigenvalue: kind `approximation`. `count` of each.
[[nodiscard]] std::vector<TheoryRow> validate_formulas(int count, std::uint64_t seed);

/// Largest and root mean square of the rows' shares off.
struct TheoryErrors {
  double largest = 0, rms = 0;
};
[[nodiscard]] TheoryErrors errors_of(const std::vector<TheoryRow>& rows);

}  // namespace spm::stability
