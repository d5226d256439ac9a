// SPDX-License-Identifier: GPL-3.0-or-later
#include "baker/trials/served_trials.hpp"

#include <tbb/parallel_for.h>

#include <algorithm>
#include <cmath>
#include <vector>

#include "baker/trials/band_trials.hpp"
#include "common/query/query.hpp"

namespace spm::baker {

namespace {

constexpr std::uint64_t trials = 400'000;

struct Outcome {
  bool counts = false;
  bool answered = false;
  double error = 0;  ///< m
};

Outcome outcome_at(const AssetView& view, const Caster& caster, const Vector3& point) {
  Outcome outcome;
  const double truth = caster.closest(point).distance;
  if (truth > view.band.margin || truth < -view.band.max_depth) return outcome;
  const Answer answer = query_point(view, point);
  if (answer.status == Status::pruned) return outcome;
  outcome.counts = true;
  // The answer beyond the margin says at least that much, which is right at the band's end.
  const bool at_end = answer.status == Status::far && view.band.margin - truth <= view.tolerance;
  outcome.answered = at_end || answer.status != Status::far;
  if (!outcome.answered) return outcome;
  const double distance = at_end ? view.band.margin : answer.distance;
  outcome.error = std::abs(distance - truth);
  return outcome;
}

}  // namespace

ServedTrials try_served(const AssetView& view, const Caster& caster, std::uint64_t seed) {
  const BandTrials band(caster, view.band, view.tolerance, seed);
  std::vector<Outcome> outcomes(trials);
  tbb::parallel_for(std::uint64_t{0}, trials, [&](std::uint64_t i) {
    outcomes[i] = outcome_at(view, caster, band.point(i));
  });
  ServedTrials found;
  for (std::uint64_t i = 0; i < trials; ++i) {
    const Outcome& outcome = outcomes[i];
    if (!outcome.counts) continue;
    ++found.count;
    if (!outcome.answered) {
      if (found.unanswered++ == 0) found.worst = band.point(i);
      continue;
    }
    found.beyond += outcome.error > view.tolerance ? 1 : 0;
    if (outcome.error <= found.largest) continue;
    found.largest = outcome.error;
    if (found.unanswered == 0) found.worst = band.point(i);
  }
  return found;
}

}  // namespace spm::baker
