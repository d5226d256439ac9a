// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <cstddef>
#include <cstdint>
#include <vector>

#include "baker/verify/verify.hpp"
#include "common/query/query.hpp"

namespace spm::baker {

/// Directions are looked at in the first places alone, of samples, of hard places and of jumps:
/// which others compete takes longer to find out than all else, and quantiles of these are sharp.
inline constexpr std::uint64_t most_directions = 100'000;

/// Nearer to the surface, m, the direction is lost in rounding.
inline constexpr double min_distance_of_direction = 2e-6;

/// Nearest-rank quantiles and the root of the mean square; 0 where there are no errors.
[[nodiscard]] ErrorSummary summarise(std::vector<double> errors);

/// One sample and the asset's result there.
struct Outcome {
  bool drawn = false;  ///< a place in the band was found
  Vector3 point = Vector3::Zero();
  double truth = 0;
  bool answered = false;
  bool far = false;       ///< the asset answers: outside, beyond the margin
  bool pruned = false;    ///< the bake left this place out
  bool doubtful = false;  ///< the truth is one of several (DoubtfulGaps)
  double answer = 0;
  double error = 0;
  double smoothing_error = 0;
  double total_error = 0;
  Source source = Source::none;
  bool directed = false;        ///< its direction was looked at
  double direction_error = -1;  ///< rad; negative where no direction is defined or answered
  bool contested = false;       ///< the error is from the nearest of the directions that compete
};

/// All but the worst places and the settings; `threshold` in metres.
[[nodiscard]] VerifyReport report_of(const std::vector<Outcome>& outcomes, double threshold);

/// Adds the changes by smoothing to a report.
void add_smoothing(const std::vector<Outcome>& outcomes, VerifyReport& report);

/// At most `count` of the worst places of both, unanswered ones first, then by error; among equals
/// those drawn first, and samples before hard places. Pruned places are none of them.
[[nodiscard]] std::vector<WorstPlace> worst_places(const std::vector<Outcome>& samples,
                                                   const std::vector<Outcome>& hard,
                                                   double threshold, std::size_t count);

}  // namespace spm::baker
