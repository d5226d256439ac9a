// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <cmath>
#include <cstdint>
#include <memory>
#include <mutex>
#include <span>
#include <tuple>
#include <vector>

#include "baker/cast/cast.hpp"
#include "baker/charts/plane_charts.hpp"
#include "baker/surface/outer_surface.hpp"
#include "common/surface/height_chart.hpp"
#include "common/surface/support_plane.hpp"

namespace spm::baker {

/// A distance map: a chart at one of its spacings, of the surface or of the offset surface.
struct ChartAtLevel {
  std::uint32_t chart = 0, level = 0;
  bool offset = false;
  [[nodiscard]] bool operator<(const ChartAtLevel& other) const noexcept {
    return std::tie(chart, level, offset) < std::tie(other.chart, other.level, other.offset);
  }
};

/// The heights of a chart at one spacing (HeightChart), as the file would store them. NaN where the
/// surface does not tell any.
struct HeightGrid {
  double spacing = 0;                  ///< m
  std::int32_t column0 = 0, row0 = 0;  ///< of the plane's lattice
  std::uint32_t columns = 0, rows = 0;
  float base = 0;              ///< m below the support plane
  std::vector<float> heights;  ///< m below the base

  /// m, of a column and a row.
  [[nodiscard]] double eta(std::size_t column) const noexcept {
    return spacing * (column0 + static_cast<double>(column));
  }
  [[nodiscard]] double omega(std::size_t row) const noexcept {
    return spacing * (row0 + static_cast<double>(row));
  }
  [[nodiscard]] float at(std::int64_t column, std::int64_t row) const noexcept {
    return heights[static_cast<std::size_t>(row) * columns + static_cast<std::size_t>(column)];
  }
};

/// How distance maps are sampled.
struct MapSampling {
  double coarsest = 0;       ///< m, of level 0, for flat charts; each level halves it
  std::uint32_t curved = 0;  ///< the first level of charts that are not flat
  std::uint32_t levels = 1;  ///< of all
  double flat_within = 0;    ///< m: a chart is flat where its corners are no farther off a plane
  bool halves = false;       ///< heights are HALF samples, not FLOAT, unless much is flat
  double offset = 0;         ///< m, below 0: of the offset surface that is sampled too
  std::uint32_t offset_levels = 0;  ///< as `levels`, of that; 0 for none of it
};

/// The distance maps (eq. 2) of all charts at several spacings, each made when it is first asked
/// for. Those of a flat chart are its plane's. Of others a height is a fixed function of where the
/// rays around it along the plane's normal meet the chart's triangles, at half the spacing: the
/// B-spline coefficient of the quadratic that is nearest to these in the mean. Past the chart's
/// border it goes on with that quadratic. Where feet of deep places lie close together, the surface
/// tells little of how the distance goes on there; so charts that are not flat are sampled of an
/// offset surface too, below the same rays. Any number of threads may ask. The same for any number
/// of threads.
class ChartHeights {
 public:
  /// All arguments must outlive this. `caster` is over the surface.
  ChartHeights(const Caster& caster, const OuterSurface& surface,
               std::span<const SupportPlane> planes, const PlaneCharts& charts,
               const MapSampling& sampling);
  ~ChartHeights();
  ChartHeights(const ChartHeights&) = delete;
  ChartHeights& operator=(const ChartHeights&) = delete;

  [[nodiscard]] const HeightGrid& of(const ChartAtLevel& map) const;
  [[nodiscard]] const PlaneCharts& charts() const noexcept { return charts_; }
  /// The plane of a chart.
  [[nodiscard]] const SupportPlane& plane(std::uint32_t chart) const noexcept {
    return planes_[charts_.charts()[chart].plane];
  }
  [[nodiscard]] std::span<const SupportPlane> planes() const noexcept { return planes_; }
  /// m, of a level.
  [[nodiscard]] double spacing(std::uint32_t level) const noexcept {
    return std::ldexp(sampling_.coarsest, -static_cast<int>(level));
  }
  [[nodiscard]] bool halves() const noexcept { return sampling_.halves; }
  /// m, of the signed distance: where the offset surface lies, or 0 for the surface.
  [[nodiscard]] double offset(const ChartAtLevel& map) const noexcept {
    return map.offset ? sampling_.offset : 0;
  }
  /// Levels at which a chart is worth a trial: the first, and the one behind the last. An offset
  /// surface is smoother, so that its finest one is not.
  [[nodiscard]] std::uint32_t first_level(std::uint32_t chart, bool offset) const noexcept {
    return flat_[chart].is && !offset ? 0 : sampling_.curved;
  }
  [[nodiscard]] std::uint32_t end_level(std::uint32_t chart, bool offset) const noexcept {
    if (flat_[chart].is && !offset) return 1;
    return offset ? sampling_.offset_levels : sampling_.levels;
  }

 private:
  /// D_SP of a flat chart: depth + by_eta eta + by_omega omega.
  struct FlatChart {
    bool is = false;
    double depth = 0, by_eta = 0, by_omega = 0;
  };
  struct Slot {
    std::once_flag once;
    HeightGrid grid;
  };
  const Caster& caster_;
  const OuterSurface& surface_;
  std::span<const SupportPlane> planes_;
  const PlaneCharts& charts_;
  MapSampling sampling_;
  std::vector<FlatChart> flat_;
  std::unique_ptr<Slot[]> slots_;

  [[nodiscard]] FlatChart flat_of(const PlaneChart& chart) const;
  [[nodiscard]] HeightGrid flat_grid(const ChartAtLevel& map) const;
  [[nodiscard]] HeightGrid curved_grid(const ChartAtLevel& map) const;
};

}  // namespace spm::baker
