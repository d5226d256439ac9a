// SPDX-License-Identifier: GPL-3.0-or-later
#include "baker/verify/outcome.hpp"

#include <algorithm>
#include <cmath>
#include <tuple>
#include <utility>

namespace spm::baker {
namespace {

/// Nearest-rank quantile of sorted values; 0 where there are none.
double quantile(const std::vector<double>& sorted, double share) {
  if (sorted.empty()) return 0;
  const double rank = std::ceil(share * static_cast<double>(sorted.size()));
  const auto index = static_cast<std::size_t>(std::max(rank, 1.0)) - 1;
  return sorted[std::min(index, sorted.size() - 1)];
}

double share_of(std::uint64_t part, std::uint64_t whole) {
  return whole > 0 ? static_cast<double>(part) / static_cast<double>(whole) : 0;
}

/// True where an inside sample was answered as outside, or the other way round.
bool sides_differ(const Outcome& outcome) {
  const bool outside = outcome.far || (outcome.answered && outcome.answer > 0);
  if (outcome.truth < 0) return outside;
  return outcome.answered && !outside;
}

/// The same, farther from the surface than the threshold. Nearer, either side is within it.
bool wrong_side(const Outcome& outcome, double threshold) {
  return std::abs(outcome.truth) > threshold && sides_differ(outcome);
}

Finding finding_of(const Outcome& outcome, double threshold) {
  if (!outcome.answered) return Finding::unanswered;
  if (wrong_side(outcome, threshold)) return Finding::wrong_side;
  return outcome.error > threshold ? Finding::beyond_tolerance : Finding::within;
}

Counts counts_of(const std::vector<Outcome>& outcomes, double threshold) {
  Counts counts;
  for (const Outcome& outcome : outcomes) {
    if (!outcome.drawn) continue;
    counts.pruned += outcome.pruned ? 1 : 0;
    counts.doubtful_gaps += outcome.doubtful ? 1 : 0;
    counts.unanswered += outcome.answered || outcome.pruned ? 0 : 1;
    counts.wrong_side += wrong_side(outcome, threshold) ? 1 : 0;
    counts.beyond_tolerance += outcome.answered && outcome.error > threshold ? 1 : 0;
  }
  return counts;
}

void add_distances(const std::vector<Outcome>& outcomes, VerifyReport& report) {
  std::vector<double> errors;
  std::uint64_t from_triangles = 0;
  double worst = -1;
  for (const Outcome& outcome : outcomes) {
    if (!outcome.drawn || !outcome.answered) continue;
    errors.push_back(outcome.error);
    from_triangles += outcome.source == Source::triangles ? 1 : 0;
    if (outcome.error > worst) {
      worst = outcome.error;
      report.worst_point = outcome.point;
    }
  }
  report.fallback_answers = share_of(from_triangles, errors.size());
  report.distance = summarise(std::move(errors));
}

void add_histogram(const std::vector<Outcome>& outcomes, double threshold, VerifyReport& report) {
  report.histogram.assign(histogram_bins + 1, 0);
  for (const Outcome& outcome : outcomes) {
    if (!outcome.drawn || !outcome.answered) continue;
    const double place = outcome.error / threshold * double{histogram_bins};
    ++report.histogram[outcome.error > threshold
                           ? histogram_bins
                           : std::min(static_cast<std::size_t>(place), histogram_bins - 1)];
  }
}

void add_sides(const std::vector<Outcome>& outcomes, double threshold, VerifyReport& report) {
  std::uint64_t clear = 0, inside_wrong = 0, outside_wrong = 0;
  for (const Outcome& outcome : outcomes) {
    if (!outcome.drawn || !(std::abs(outcome.truth) > threshold)) continue;
    ++clear;
    if (sides_differ(outcome)) ++(outcome.truth < 0 ? inside_wrong : outside_wrong);
  }
  report.inside_as_outside = share_of(inside_wrong, clear);
  report.outside_as_inside = share_of(outside_wrong, clear);
}

void add_directions(const std::vector<Outcome>& outcomes, VerifyReport& report) {
  std::vector<double> clear, contested;
  std::uint64_t left_out = 0;
  for (const Outcome& outcome : outcomes) {
    if (!outcome.drawn || !outcome.directed) continue;
    ++report.directions;
    left_out += outcome.contested ? 1 : 0;
    if (outcome.direction_error < 0) continue;
    (outcome.contested ? contested : clear).push_back(outcome.direction_error);
  }
  std::sort(clear.begin(), clear.end());
  std::sort(contested.begin(), contested.end());
  report.direction_contested = share_of(left_out, report.directions);
  report.direction_p50 = quantile(clear, 0.5);
  report.direction_p99 = quantile(clear, 0.99);
  report.direction_max = quantile(clear, 1);
  report.contested_p50 = quantile(contested, 0.5);
  report.contested_p99 = quantile(contested, 0.99);
  report.contested_max = quantile(contested, 1);
}

/// A place by how bad it is; sorts before all that are less so.
struct Rank {
  bool answered;
  double error;
  bool hard;
  std::size_t index;

  bool operator<(const Rank& other) const {
    return std::tuple(answered, -error, hard, index) <
           std::tuple(other.answered, -other.error, other.hard, other.index);
  }
};

/// Leaves only the first `count` in order.
void keep_first(std::vector<Rank>& ranks, std::size_t count) {
  if (ranks.size() <= count) return;
  std::nth_element(ranks.begin(), ranks.begin() + static_cast<std::ptrdiff_t>(count), ranks.end());
  ranks.resize(count);
}

void add_ranks(const std::vector<Outcome>& outcomes, bool hard, std::size_t count,
               std::vector<Rank>& ranks) {
  for (std::size_t i = 0; i < outcomes.size(); ++i) {
    const Outcome& outcome = outcomes[i];
    if (!outcome.drawn || outcome.pruned) continue;
    ranks.push_back({outcome.answered, outcome.error, hard, i});
    if (ranks.size() > 2 * count + 1000) keep_first(ranks, count);
  }
}

}  // namespace

ErrorSummary summarise(std::vector<double> errors) {
  ErrorSummary summary;
  double squares = 0;
  for (const double error : errors) squares += error * error;
  if (!errors.empty()) summary.rms = std::sqrt(squares / static_cast<double>(errors.size()));
  std::sort(errors.begin(), errors.end());
  summary.p50 = quantile(errors, 0.5);
  summary.p99 = quantile(errors, 0.99);
  summary.p999 = quantile(errors, 0.999);
  summary.max = errors.empty() ? 0 : errors.back();
  return summary;
}

const char* name_of(Finding finding) noexcept {
  switch (finding) {
    case Finding::unanswered:
      return "unanswered";
    case Finding::wrong_side:
      return "wrong_side";
    case Finding::beyond_tolerance:
      return "beyond_tolerance";
    case Finding::within:
      break;
  }
  return "within";
}

std::uint64_t VerifyReport::judged() const noexcept {
  return samples - counts.pruned + adversarial.samples - adversarial.counts.pruned;
}

std::uint64_t VerifyReport::missed() const noexcept {
  return counts.missed() + adversarial.counts.missed();
}

bool VerifyReport::passed() const noexcept {
  return !tolerance || (judged() > 0 && missed() == 0 && jumps.beyond == 0);
}

VerifyReport report_of(const std::vector<Outcome>& outcomes, double threshold) {
  VerifyReport report;
  for (const Outcome& outcome : outcomes) report.samples += outcome.drawn ? 1 : 0;
  report.counts = counts_of(outcomes, threshold);
  report.unanswered = share_of(report.counts.unanswered, report.samples);
  report.pruned = share_of(report.counts.pruned, report.samples);
  report.not_judged = share_of(outcomes.size() - report.samples, outcomes.size());
  report.threshold = threshold;
  add_distances(outcomes, report);
  add_histogram(outcomes, threshold, report);
  add_sides(outcomes, threshold, report);
  add_directions(outcomes, report);
  return report;
}

void add_smoothing(const std::vector<Outcome>& outcomes, VerifyReport& report) {
  std::vector<double> smoothing, total;
  for (const Outcome& outcome : outcomes) {
    if (!outcome.drawn) continue;
    smoothing.push_back(outcome.smoothing_error);
    if (outcome.answered) total.push_back(outcome.total_error);
  }
  report.smoothing = summarise(std::move(smoothing));
  report.total = summarise(std::move(total));
}

std::vector<WorstPlace> worst_places(const std::vector<Outcome>& samples,
                                     const std::vector<Outcome>& hard, double threshold,
                                     std::size_t count) {
  std::vector<Rank> ranks;
  add_ranks(samples, false, count, ranks);
  add_ranks(hard, true, count, ranks);
  keep_first(ranks, count);
  std::sort(ranks.begin(), ranks.end());
  std::vector<WorstPlace> worst;
  worst.reserve(ranks.size());
  for (const Rank& rank : ranks) {
    const Outcome& outcome = (rank.hard ? hard : samples)[rank.index];
    WorstPlace place{outcome.point, outcome.truth, {}, finding_of(outcome, threshold), rank.hard};
    if (outcome.answered) place.error = outcome.error;
    worst.push_back(place);
  }
  return worst;
}

}  // namespace spm::baker
