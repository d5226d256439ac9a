// SPDX-License-Identifier: GPL-3.0-or-later
#include "baker/verify/doubtful_gaps.hpp"

#include <tbb/parallel_for.h>

#include <algorithm>
#include <cmath>
#include <cstddef>

#include "baker/verify/exact_surface.hpp"

namespace spm::baker {
namespace {

/// Signed distances, m, between which the truth lies.
struct Range {
  double low = 0, high = 0;
  void extend(double value) {
    low = std::min(low, value);
    high = std::max(high, value);
  }
  [[nodiscard]] double off(double value) const {
    return std::max({0.0, low - value, value - high});
  }
};

void judge(const Range& truth, const Band& band, double tolerance, Outcome& outcome) {
  if (outcome.answered) {
    outcome.error = truth.off(outcome.answer);
  } else if (outcome.far && truth.high >= band.margin - tolerance) {
    outcome.answered = true;
    outcome.answer = band.margin;
  }
}

}  // namespace

void judge_doubtful_gaps(const Mesh& mesh, const AssetView& view, double tolerance,
                         std::vector<Outcome>& outcomes) {
  std::vector<std::size_t> wrong;
  for (std::size_t i = 0; i < outcomes.size(); ++i) {
    const Outcome& outcome = outcomes[i];
    if (!outcome.drawn || outcome.pruned) continue;
    if (!outcome.answered || outcome.error > tolerance) wrong.push_back(i);
  }
  if (wrong.empty()) return;
  const ExactSurface open(mesh, view.sheet_thickness, surely_closed * tolerance),
      closed(mesh, view.sheet_thickness, surely_open * tolerance);
  tbb::parallel_for(std::size_t{0}, wrong.size(), [&](std::size_t i) {
    Outcome& outcome = outcomes[wrong[i]];
    Range truth{outcome.truth, outcome.truth};
    for (const ExactSurface* surface : {&open, &closed}) {
      if (surface->empty()) continue;
      truth.extend(surface->distance(outcome.point, surface->closest(outcome.point)));
    }
    judge(truth, view.band, tolerance, outcome);
  });
}

}  // namespace spm::baker
