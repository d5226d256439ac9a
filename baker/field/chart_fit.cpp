// SPDX-License-Identifier: GPL-3.0-or-later
#include "baker/field/chart_fit.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <numeric>

#include "baker/charts/chart_field.hpp"
#include "common/surface/edge_distance.hpp"

namespace spm::baker {

namespace {

/// A chart is taken where it has nearly as many of the triangles as any.
constexpr double enough_votes = 0.9;
/// Spacings are tried down to this share of a cube's edge.
constexpr double finest = 0.3;
/// So many charts are tried that face samples, and so many that meet them are tried to be proven;
/// of two that meet them, the first.
constexpr std::size_t tried_charts = 3;
constexpr int tried_proofs = 3;
/// Two parts with directions closer than 18 degrees are no crease: smaller cubes have one chart.
constexpr double alike_cosine = 0.95;
/// Two pieces of a cube have so many samples each, or more.
constexpr std::size_t least_samples = 4;

/// The few charts that have the triangles nearest to samples, those that face their
/// direction most first.
std::vector<std::uint32_t> facing_charts(const std::vector<CubeSample>& samples,
                                         const std::vector<std::size_t>& chosen,
                                         const ChartHeights& heights) {
  struct Votes {
    std::uint32_t chart, count;
    double facing;
  };
  std::vector<Votes> votes;
  Vector3 direction = Vector3::Zero();
  const auto vote = [&](std::uint32_t triangle) {
    for (const std::uint32_t chart : heights.charts().charts_of(triangle)) {
      const auto known = std::find_if(votes.begin(), votes.end(),
                                      [chart](const Votes& one) { return one.chart == chart; });
      if (known == votes.end()) {
        votes.push_back({chart, 1, 0});
      } else {
        ++known->count;
      }
    }
  };
  for (const std::size_t i : chosen) {
    direction += samples[i].gradient;
    vote(samples[i].triangle);
    if (samples[i].beside != samples[i].triangle) vote(samples[i].beside);
  }
  std::uint32_t most = 0;
  for (Votes& one : votes) {
    most = std::max(most, one.count);
    one.facing = heights.plane(one.chart).n.dot(direction);
  }
  std::erase_if(votes, [most](const Votes& one) {
    return one.count < enough_votes * most || !(one.facing > 0);
  });
  std::sort(votes.begin(), votes.end(), [](const Votes& a, const Votes& b) {
    return a.facing != b.facing ? a.facing > b.facing : a.chart < b.chart;
  });
  std::vector<std::uint32_t> charts;
  for (const Votes& one : votes) {
    if (charts.size() == tried_charts) break;
    charts.push_back(one.chart);
  }
  return charts;
}

/// What charts tell at the samples of a cube, each asked once.
class SampledChart {
 public:
  SampledChart(const ChartAtLevel& chart, const std::vector<CubeSample>& samples, const Cube& cube,
               const ChartHeights& heights)
      : at(chart), field_(heights, chart), samples_(samples), cube_(cube) {}

  struct Told {
    bool known = false;
    double distance = 0;               ///< m
    Vector3 normal = Vector3::Zero();  ///< of length 1
  };
  [[nodiscard]] const Told& told(std::size_t sample) {
    if (told_.empty()) told_.resize(samples_.size());
    Told& told = told_[sample];
    if (!told.known) {
      told.known = true;
      told.distance = field_.at(cube_.middle + cube_.half * samples_[sample].place, told.normal);
      told.normal.normalize();
    }
    return told;
  }

  ChartAtLevel at;

 private:
  ChartField field_;
  const std::vector<CubeSample>& samples_;
  const Cube& cube_;
  std::vector<Told> told_;
};

/// Whether what one chart tells, or two, meets samples of the band: the error of each, and
/// directions in the mean.
bool meet(SampledChart& first, SampledChart* second, MapPair pair,
          const std::vector<CubeSample>& samples, const ChartRules& rules) {
  SampleJudge judge(rules.band, rules.max_error, rules.max_mean_angle);
  const auto edge_at = [&](std::size_t i) {
    const auto &one = first.told(i), &other = second->told(i);
    const double sign = pair.larger ? 1 : -1;
    EdgeDistance edge = edge_distance(sign * one.distance, sign * other.distance,
                                      pair.edge ? one.normal.dot(other.normal) : 1);
    edge.distance *= sign;
    return edge;
  };
  // Samples that follow each other lie side by side, so those far apart are tried first.
  constexpr std::size_t apart = 27;
  for (std::size_t from = 0; from < apart; ++from) {
    for (std::size_t i = from; i < samples.size(); i += apart) {
      const double distance = second == nullptr ? first.told(i).distance : edge_at(i).distance;
      if (!judge.meets(samples[i], distance)) return false;
    }
  }
  for (std::size_t i = 0; i < samples.size(); ++i) {
    if (second == nullptr) {
      judge.add(samples[i], first.told(i).normal);
    } else {
      const EdgeDistance edge = edge_at(i);
      judge.add(samples[i],
                edge.first * first.told(i).normal + edge.second * second->told(i).normal);
    }
  }
  return judge.meets_directions();
}

/// The charts that face samples, at each spacing at which they cover the cube: the
/// chart that faces them most first, each from its coarsest spacing on. First of the surface,
/// whose heights cubes above share, then of the offset surface.
std::vector<SampledChart> charts_over(const std::vector<CubeSample>& samples,
                                      const std::vector<std::size_t>& chosen, const Cube& cube,
                                      const ChartHeights& heights) {
  std::vector<SampledChart> found;
  const std::vector<std::uint32_t> facing = facing_charts(samples, chosen, heights);
  for (const bool offset : {false, true}) {
    for (const std::uint32_t chart : facing) {
      const std::uint32_t end = heights.end_level(chart, offset);
      for (std::uint32_t level = heights.first_level(chart, offset); level < end; ++level) {
        if (heights.spacing(level) < finest * 2 * cube.half) break;
        const ChartAtLevel map{chart, level, offset};
        // A finer spacing reaches less far past the chart's border.
        if (!ChartField(heights, map).covers(cube.middle, cube.half)) break;
        found.emplace_back(map, samples, cube, heights);
      }
    }
  }
  return found;
}

}  // namespace

std::optional<FittedCharts> find_one_chart(const std::vector<CubeSample>& samples, const Cube& cube,
                                           const ChartRules& rules, const ChartProof& proven) {
  std::vector<std::size_t> chosen = about_band(samples, rules.band, cube.half);
  if (chosen.empty()) {
    chosen.resize(samples.size());
    std::iota(chosen.begin(), chosen.end(), std::size_t{0});
  }
  int proofs = 0;
  for (SampledChart& chart : charts_over(samples, chosen, cube, *rules.heights)) {
    if (!meet(chart, nullptr, {}, samples, rules)) continue;
    FittedCharts fitted{{}, {chart.at}};
    if (proven(fitted)) return fitted;
    if (++proofs == tried_proofs) break;
  }
  return std::nullopt;
}

std::optional<FittedCharts> find_two_charts(const std::vector<CubeSample>& samples,
                                            const Cube& cube, const ChartRules& rules,
                                            const ChartProof& proven) {
  const std::vector<std::size_t> chosen = about_band(samples, rules.band, cube.half);
  if (chosen.size() < 2 * least_samples) return std::nullopt;
  const std::vector<bool> is_second = by_direction(samples, chosen);
  std::array<std::vector<std::size_t>, 2> parts;
  for (const std::size_t i : chosen) parts[is_second[i] ? 1 : 0].push_back(i);
  std::array<Vector3, 2> directions{Vector3::Zero(), Vector3::Zero()};
  for (std::size_t k = 0; k < 2; ++k) {
    if (parts[k].size() < least_samples) return std::nullopt;
    for (const std::size_t i : parts[k]) directions[k] += samples[i].gradient;
  }
  if (directions[0].dot(directions[1]) >
      alike_cosine * directions[0].norm() * directions[1].norm()) {
    return std::nullopt;
  }
  std::vector<SampledChart> seconds = charts_over(samples, parts[1], cube, *rules.heights);
  for (SampledChart& first : charts_over(samples, parts[0], cube, *rules.heights)) {
    for (SampledChart& second : seconds) {
      if (first.at.chart == second.at.chart) continue;
      for (const MapPair pair : {MapPair{false, false}, MapPair{true, false}, MapPair{false, true},
                                 MapPair{true, true}}) {
        if (!meet(first, &second, pair, samples, rules)) continue;
        FittedCharts fitted{pair, {first.at, second.at}};
        return proven(fitted) ? std::optional(fitted) : std::nullopt;
      }
    }
  }
  return std::nullopt;
}

}  // namespace spm::baker
