// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <cstdint>
#include <map>
#include <utility>
#include <vector>

#include "baker/charts/chart_field.hpp"
#include "baker/charts/chart_heights.hpp"
#include "formats/asset/asset.hpp"

namespace spm::baker {

/// Gathers which heights of which charts are needed, and lays these out in one picture, each chart
/// in its own shape, so that no height is there twice and few places are empty.
class Atlas {
 public:
  explicit Atlas(const ChartHeights& heights) : heights_(heights) {}

  /// Asks for the heights that answer in a cube.
  void need(const ChartAtLevel& chart, const Vector3& middle, double half);
  /// The picture and its charts, ascending, and their planes.
  [[nodiscard]] AtlasData lay_out(std::vector<SupportPlane>& planes);
  /// The number of the chart in the picture from which a cube is answered that asked for it, once
  /// that is laid out.
  [[nodiscard]] std::uint32_t number(const ChartAtLevel& chart, const Vector3& middle,
                                     double half) const;

 private:
  /// The heights of a chart that are needed: row by row, for each the part that it belongs to, from
  /// 1 on; 0 where it is not needed.
  struct Needed {
    std::vector<std::vector<std::uint32_t>> parts;
    HeightRange box;
    std::uint32_t first = 0;  ///< the number of the first part
  };
  const ChartHeights& heights_;
  std::map<ChartAtLevel, Needed> needed_;

  /// Tells parts that do not touch apart where the box of all is much larger; returns how many.
  static std::uint32_t find_parts(Needed& needed);
};

}  // namespace spm::baker
