// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <cstdint>
#include <memory>
#include <mutex>
#include <span>
#include <vector>

#include "baker/charts/plane_charts.hpp"
#include "baker/surface/outer_surface.hpp"
#include "common/surface/support_plane.hpp"

namespace spm::baker {

/// The heights of a chart at one spacing (HeightChart), as the file would store them. NaN where the
/// surface does not tell any.
struct HeightGrid {
  double spacing = 0;                  ///< m
  std::int32_t column0 = 0, row0 = 0;  ///< of the plane's lattice
  std::uint32_t columns = 0, rows = 0;
  std::vector<float> heights;  ///< m below the plane

  [[nodiscard]] float at(std::int64_t column, std::int64_t row) const noexcept {
    return heights[static_cast<std::size_t>(row) * columns + static_cast<std::size_t>(column)];
  }
};

/// The distance maps (eq. 2) of all charts at several spacings, each made when it is first asked
/// for. A height is a fixed function of where the rays around it along the plane's normal meet the
/// chart's triangles, at half the spacing: the B-spline coefficient of the quadratic that is
/// nearest to these in the mean. Past the chart's border it goes on with that quadratic. Any number
/// of threads may ask. The same for any number of threads.
class ChartHeights {
 public:
  /// `spacing`, m, of level 0; each level halves it. All arguments must outlive this.
  ChartHeights(const OuterSurface& surface, std::span<const SupportPlane> planes,
               const PlaneCharts& charts, double spacing, std::uint32_t levels);
  ~ChartHeights();
  ChartHeights(const ChartHeights&) = delete;
  ChartHeights& operator=(const ChartHeights&) = delete;

  [[nodiscard]] const HeightGrid& of(std::uint32_t chart, std::uint32_t level) const;
  [[nodiscard]] const PlaneCharts& charts() const noexcept { return charts_; }
  [[nodiscard]] std::span<const SupportPlane> planes() const noexcept { return planes_; }
  [[nodiscard]] double spacing() const noexcept { return spacing_; }  ///< m, of level 0
  [[nodiscard]] std::uint32_t levels() const noexcept { return levels_; }

 private:
  struct Slot {
    std::once_flag once;
    HeightGrid grid;
  };
  const OuterSurface& surface_;
  std::span<const SupportPlane> planes_;
  const PlaneCharts& charts_;
  double spacing_;
  std::uint32_t levels_;
  std::unique_ptr<Slot[]> slots_;
};

}  // namespace spm::baker
