// SPDX-License-Identifier: Apache-2.0
#include "formats/asset/chart_words.hpp"

#include <bit>
#include <cmath>

namespace spm {

namespace {

constexpr std::uint32_t offset_bit = 1U << 31U;

std::uint32_t halves(std::int32_t low, std::int32_t high) {
  return (static_cast<std::uint32_t>(low) & 0xFFFFU) | static_cast<std::uint32_t>(high) << 16U;
}
std::int16_t low_of(std::uint32_t word) { return static_cast<std::int16_t>(word & 0xFFFFU); }
std::int16_t high_of(std::uint32_t word) { return static_cast<std::int16_t>(word >> 16U); }

bool fits(std::int64_t number) { return number == static_cast<std::int16_t>(number); }

}  // namespace

std::vector<std::uint32_t> words_of(const std::vector<ChartData>& charts) {
  std::vector<std::uint32_t> words;
  words.reserve(charts.size() * chart_word_count);
  for (const ChartData& chart : charts) {
    words.insert(words.end(), {chart.plane | chart.level << 16U | (chart.offset ? offset_bit : 0U),
                               halves(chart.column0, chart.row0), chart.columns | chart.rows << 16U,
                               chart.first, std::bit_cast<std::uint32_t>(chart.base)});
  }
  return words;
}

HeightChart chart_over(const ChartData& data, const SupportPlane& plane, const AtlasData& atlas,
                       const StoredHeights& heights) noexcept {
  HeightChart chart = chart_on(plane, std::ldexp(atlas.spacing, -static_cast<int>(data.level)),
                               data.column0, data.row0, static_cast<double>(data.base));
  chart.heights = heights.from(data.first);
  chart.stride = atlas.width;
  chart.columns = static_cast<std::uint16_t>(data.columns);
  chart.rows = static_cast<std::uint16_t>(data.rows);
  chart.plane = data.plane;
  chart.offset = data.offset ? static_cast<float>(atlas.offset) : 0;
  return chart;
}

std::string chart_problem(const ChartData& chart, std::size_t planes, std::uint32_t width,
                          std::uint64_t heights) {
  if (chart.plane >= planes || chart.plane >= max_chart_planes) {
    return "names a plane that does not exist";
  }
  if (chart.level >= max_chart_levels) return "has a level that does not exist";
  if (!std::isfinite(chart.base)) return "has a base that is no depth";
  if (!fits(chart.column0) || !fits(chart.row0)) return "begins too far from its plane's origin";
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
    chart.level = (own[0] & ~offset_bit) >> 16U;
    chart.offset = (own[0] & offset_bit) != 0;
    chart.column0 = low_of(own[1]);
    chart.row0 = high_of(own[1]);
    chart.columns = own[2] & 0xFFFFU;
    chart.rows = own[2] >> 16U;
    chart.first = own[3];
    chart.base = std::bit_cast<float>(own[4]);
  }
  return charts;
}

}  // namespace spm
