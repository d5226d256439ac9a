// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <span>

#include "tests/bench/methods/method.hpp"
#include "tests/bench/model/places.hpp"

namespace spm::bench {

/// How far a method's answers are from the truth.
struct Score {
  double rms = 0, p50 = 0, p99 = 0, max = 0;    ///< m, over the answered places
  double direction_p50 = 0, direction_p99 = 0;  ///< rad, of the places with a direction
  double misclassified = 0;  ///< share of the places farther off than the tolerance
  double unanswered = 0;     ///< share of all places
};

/// Asks a method at every place, on this thread. `deep` counts as the band's bottom; `far` as the
/// margin within the tolerance of it, and as no answer elsewhere. The tolerance is the method's
/// own, or where it has none the model's.
[[nodiscard]] Score score(const Method& method, const Model& model, const Places& places);

/// The same for answers that already exist, one per place, in the same order.
[[nodiscard]] Score score(std::span<const Answer> answers, const Model& model, const Places& places,
                          double tolerance);

}  // namespace spm::bench
