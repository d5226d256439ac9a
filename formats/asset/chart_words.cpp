// SPDX-License-Identifier: Apache-2.0
#include "formats/asset/chart_words.hpp"

#include <bit>
#include <cmath>

namespace spm {

std::vector<std::uint32_t> words_of(const std::vector<ChartData>& charts) {
  std::vector<std::uint32_t> words;
  words.reserve(charts.size() * chart_word_count);
  for (const ChartData& chart : charts) {
    words.insert(words.end(),
                 {chart.plane | chart.level << 16U, static_cast<std::uint32_t>(chart.column0),
                  static_cast<std::uint32_t>(chart.row0), chart.columns | chart.rows << 16U,
                  chart.first, std::bit_cast<std::uint32_t>(chart.base.depth),
                  std::bit_cast<std::uint32_t>(chart.base.by_eta),
                  std::bit_cast<std::uint32_t>(chart.base.by_omega)});
  }
  return words;
}

HeightChart chart_over(const ChartData& data, const SupportPlane& plane, const AtlasData& atlas,
                       const StoredHeights& heights) noexcept {
  HeightChart chart = chart_on(plane, std::ldexp(atlas.spacing, -static_cast<int>(data.level)),
                               data.column0, data.row0, data.base);
  chart.heights = heights.from(data.first);
  chart.stride = atlas.width;
  chart.columns = data.columns;
  chart.rows = data.rows;
  chart.plane = data.plane;
  return chart;
}

std::string chart_problem(const ChartData& chart, std::size_t planes, std::uint32_t width,
                          std::uint64_t heights) {
  if (chart.plane >= planes || chart.plane >= max_chart_planes) {
    return "names a plane that does not exist";
  }
  if (chart.level >= max_chart_levels) return "has a level that does not exist";
  const ChartBase& base = chart.base;
  if (!std::isfinite(base.depth) || !std::isfinite(base.by_eta) || !std::isfinite(base.by_omega)) {
    return "has a base that is no plane";
  }
  if (chart.columns < 3 || chart.rows < 3 || chart.columns > width || chart.columns > 0xFFFFU ||
      chart.rows > 0xFFFFU) {
    return "has a size that no chart has";
  }
  // One more height may be read behind the last.
  const std::uint64_t end = chart.first + std::uint64_t{chart.rows - 1} * width + chart.columns + 1;
  if (end > heights) return "lies outside the picture of heights";
  return {};
}

std::vector<ChartData> read_charts(std::span<const std::uint32_t> words) {
  std::vector<ChartData> charts;
  charts.reserve(words.size() / chart_word_count);
  for (std::size_t at = 0; at + chart_word_count <= words.size(); at += chart_word_count) {
    const std::uint32_t* own = words.data() + at;
    ChartData& chart = charts.emplace_back();
    chart.plane = own[0] & 0xFFFFU;
    chart.level = own[0] >> 16U;
    chart.column0 = static_cast<std::int32_t>(own[1]);
    chart.row0 = static_cast<std::int32_t>(own[2]);
    chart.columns = own[3] & 0xFFFFU;
    chart.rows = own[3] >> 16U;
    chart.first = own[4];
    chart.base = {std::bit_cast<float>(own[5]), std::bit_cast<float>(own[6]),
                  std::bit_cast<float>(own[7])};
  }
  return charts;
}

}  // namespace spm
