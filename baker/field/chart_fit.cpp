// SPDX-License-Identifier: GPL-3.0-or-later
#include "baker/field/chart_fit.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <span>

#include "baker/charts/chart_field.hpp"

namespace spm::baker {

namespace {

/// A chart is taken where it has nearly as many of the triangles as any.
constexpr double enough_votes = 0.9;
/// Spacings are tried down to this share of a cube's edge.
constexpr double finest = 0.3;
/// Two pieces of a cube have so many samples each, or more.
constexpr std::size_t least_samples = 4;

/// The chart that has the triangles nearest to samples and faces their direction most.
std::optional<std::uint32_t> facing_chart(const std::vector<CubeSample>& samples,
                                          const std::vector<std::size_t>& chosen,
                                          const ChartHeights& heights) {
  struct Votes {
    std::uint32_t chart, count;
  };
  std::vector<Votes> votes;
  Vector3 direction = Vector3::Zero();
  for (const std::size_t i : chosen) {
    direction += samples[i].gradient;
    for (const std::uint32_t chart : heights.charts().charts_of(samples[i].triangle)) {
      const auto known = std::find_if(votes.begin(), votes.end(),
                                      [chart](const Votes& one) { return one.chart == chart; });
      if (known == votes.end()) {
        votes.push_back({chart, 1});
      } else {
        ++known->count;
      }
    }
  }
  std::uint32_t most = 0;
  for (const Votes& one : votes) most = std::max(most, one.count);
  std::optional<std::uint32_t> best;
  double facing = 0;
  for (const Votes& one : votes) {
    if (one.count < enough_votes * most) continue;
    const double cosine =
        heights.planes()[heights.charts().charts()[one.chart].plane].n.dot(direction);
    if (cosine > facing || (best && cosine == facing && one.chart < *best)) {
      best = one.chart;
      facing = cosine;
    }
  }
  return best;
}

/// Whether what fields tell meets samples of the band: the error of each, and directions in the
/// mean. With one field alone `smaller` does not matter.
bool meet(std::span<const ChartField> fields, bool smaller, const std::vector<CubeSample>& samples,
          const std::vector<std::size_t>& chosen, const Cube& cube, const ChartRules& rules) {
  SampleJudge judge(rules.band, rules.max_error, rules.max_mean_angle);
  for (const std::size_t i : chosen) {
    const CubeSample& sample = samples[i];
    const Vector3 place = cube.middle + cube.half * sample.place;
    Vector3 normal;
    double value = fields.front().at(place, normal);
    if (fields.size() > 1) {
      Vector3 other_normal;
      const double other = fields.back().at(place, other_normal);
      if ((other < value) == smaller) {
        value = other;
        normal = other_normal;
      }
    }
    if (!judge.meets(sample, value, normal)) return false;
  }
  return judge.meets_directions();
}

/// The chart that faces chosen samples, at the coarsest spacing that meets them.
std::optional<ChartAtLevel> find_chart(const std::vector<CubeSample>& samples,
                                       const std::vector<std::size_t>& chosen,
                                       const std::vector<std::size_t>& judged, const Cube& cube,
                                       const ChartRules& rules) {
  const std::optional<std::uint32_t> chart = facing_chart(samples, chosen, *rules.heights);
  if (!chart) return std::nullopt;
  for (std::uint32_t level = rules.heights->first_level(*chart);
       level < rules.heights->end_level(*chart); ++level) {
    const double spacing = std::ldexp(rules.heights->spacing(), -static_cast<int>(level));
    if (spacing < finest * 2 * cube.half) break;
    const ChartField field(*rules.heights, *chart, level);
    // A finer spacing reaches less far past the chart's border.
    if (!field.covers(cube.middle, cube.half)) break;
    if (meet({&field, 1}, true, samples, judged, cube, rules)) return ChartAtLevel{*chart, level};
  }
  return std::nullopt;
}

std::vector<std::size_t> all_of(const std::vector<CubeSample>& samples) {
  std::vector<std::size_t> numbers(samples.size());
  for (std::size_t i = 0; i < numbers.size(); ++i) numbers[i] = i;
  return numbers;
}

}  // namespace

std::optional<FittedCharts> find_one_chart(const std::vector<CubeSample>& samples, const Cube& cube,
                                           const ChartRules& rules) {
  const std::vector<std::size_t> all = all_of(samples);
  std::vector<std::size_t> chosen = about_band(samples, rules.band, cube.half);
  if (chosen.empty()) chosen = all;
  const std::optional<ChartAtLevel> found = find_chart(samples, chosen, all, cube, rules);
  if (!found) return std::nullopt;
  return FittedCharts{OctreeKind::map, {*found}};
}

std::optional<FittedCharts> find_two_charts(const std::vector<CubeSample>& samples,
                                            const Cube& cube, const ChartRules& rules) {
  const std::vector<std::size_t> chosen = about_band(samples, rules.band, cube.half);
  if (chosen.size() < 2 * least_samples) return std::nullopt;
  const std::vector<bool> is_second = by_direction(samples, chosen);
  std::array<std::vector<std::size_t>, 2> parts;
  for (const std::size_t i : chosen) parts[is_second[i] ? 1 : 0].push_back(i);
  FittedCharts fitted;
  std::vector<ChartField> fields;
  for (const auto& part : parts) {
    if (part.size() < least_samples) return std::nullopt;
    const std::optional<ChartAtLevel> found = find_chart(samples, part, part, cube, rules);
    if (!found) return std::nullopt;
    fitted.charts.push_back(*found);
    fields.emplace_back(*rules.heights, found->chart, found->level);
  }
  if (fitted.charts[0].chart == fitted.charts[1].chart) return std::nullopt;
  const std::vector<std::size_t> all = all_of(samples);
  for (const OctreeKind how : {OctreeKind::least, OctreeKind::most}) {
    fitted.how = how;
    if (meet(fields, how == OctreeKind::least, samples, all, cube, rules)) return fitted;
  }
  return std::nullopt;
}

}  // namespace spm::baker
