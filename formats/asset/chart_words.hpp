// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <span>
#include <string>
#include <vector>

#include "common/surface/height_chart.hpp"
#include "common/surface/support_plane.hpp"
#include "formats/asset/asset.hpp"

namespace spm {

// The data of a chart beside its heights, as chart_word_count words of the part `grid_maps`:
//   0: bits 0-15 the plane, 16-23 the level, 31 whether it is of the offset surface;
//   1: column0, and row0 in the high half, signed;
//   2: columns, and rows in the high half;
//   3: the place of the first height;
//   4: the base, a float.

inline constexpr std::uint32_t chart_word_count = 5;
inline constexpr std::uint32_t max_chart_planes = 1U << 16U, max_chart_levels = 32;

[[nodiscard]] std::vector<std::uint32_t> words_of(const std::vector<ChartData>& charts);

/// A chart as queries see it, over all heights of an atlas. Of `atlas` only the shape is read.
[[nodiscard]] HeightChart chart_over(const ChartData& data, const SupportPlane& plane,
                                     const AtlasData& atlas, const StoredHeights& heights) noexcept;

/// The problem of a chart that cannot be stored, or does not lie in an atlas of so many heights;
/// empty where there is none.
[[nodiscard]] std::string chart_problem(const ChartData& chart, std::size_t planes,
                                        std::uint32_t width, std::uint64_t heights);

/// The charts that words describe; not checked.
[[nodiscard]] std::vector<ChartData> read_charts(std::span<const std::uint32_t> words);

}  // namespace spm
