// SPDX-License-Identifier: GPL-3.0-or-later
#include "baker/verify/doubtful_gaps.hpp"

#include <tbb/parallel_for.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>

namespace spm::baker {
namespace {

/// Up to these widths, in those that are closed, gaps are closed. One is in between, since a wider
/// one does not close all that it does: another wall may be a sliver then.
constexpr std::array<double, 3> widths{surely_closed, 2, surely_open};

[[nodiscard]] bool is_wrong(const Outcome& outcome, double tolerance) {
  return outcome.drawn && !outcome.pruned && (!outcome.answered || outcome.error > tolerance);
}

/// The same outcome with what comes next to its answer of the distances from `low` to `high`, m.
[[nodiscard]] Outcome judged(Outcome outcome, double low, double high, const Band& band,
                             double tolerance) {
  if (!outcome.answered && outcome.far && high >= band.margin - tolerance) {
    outcome.answered = true;
    outcome.answer = band.margin;
  }
  if (!outcome.answered) return outcome;
  outcome.truth = std::clamp(outcome.answer, low, high);
  outcome.error = std::abs(outcome.answer - outcome.truth);
  outcome.doubtful = true;
  return outcome;
}

}  // namespace

void DoubtfulGaps::judge(std::vector<Outcome>& outcomes) {
  std::vector<std::size_t> wrong;
  for (std::size_t i = 0; i < outcomes.size(); ++i) {
    if (is_wrong(outcomes[i], tolerance_)) wrong.push_back(i);
  }
  if (wrong.empty()) return;
  for (std::size_t i = surfaces_.size(); i < widths.size(); ++i) {
    surfaces_.push_back(
        std::make_unique<ExactSurface>(mesh_, view_.sheet_thickness, widths[i] * tolerance_));
  }
  tbb::parallel_for(std::size_t{0}, wrong.size(), [&](std::size_t i) {
    Outcome& outcome = outcomes[wrong[i]];
    double low = outcome.truth, high = outcome.truth;
    for (const auto& surface : surfaces_) {
      if (surface->empty()) continue;
      const double truth = surface->distance(outcome.point, surface->closest(outcome.point));
      low = std::min(low, truth);
      high = std::max(high, truth);
    }
    const Outcome settled = judged(outcome, low, high, view_.band, tolerance_);
    if (!is_wrong(settled, tolerance_)) outcome = settled;
  });
}

}  // namespace spm::baker
