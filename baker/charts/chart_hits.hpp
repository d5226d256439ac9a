// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <limits>
#include <vector>

#include "baker/cast/cast.hpp"
#include "baker/charts/plane_charts.hpp"
#include "baker/surface/outer_surface.hpp"
#include "common/surface/support_plane.hpp"

namespace spm::baker {

/// A chart's box on its plane, in steps.
struct ChartBox {
  std::array<double, 2> low{}, high{};
};

[[nodiscard]] ChartBox box_of(const OuterSurface& surface, const SupportPlane& plane,
                              const PlaneChart& chart, double step);

/// Where rays along a plane's normal, one at each place of a lattice, meet a chart: the raw
/// distance map (eq. 2) of which its heights are made.
class ChartHits {
 public:
  std::int32_t column0 = 0, row0 = 0;      ///< of the plane's lattice; even numbers
  std::uint32_t columns = 0, rows = 0;     ///< 0 where there would be too many
  double least = infinity, most = -least;  ///< of all depths, m

  /// `step`, m, from one ray to the next. The arguments must outlive this.
  ChartHits(const OuterSurface& surface, const SupportPlane& plane, const PlaneChart& chart,
            double step);

  /// Goes on from the chart to the offset surface, where the signed distance is `offset` (m, below
  /// 0), along the same rays, where the chart is what is nearest there; and sideways from there, as
  /// far as that is deep, where the offset surface goes on without a crease. `caster` is over the
  /// chart's surface.
  void go_to_offset(const Caster& caster, double offset);

  /// m below the plane; NaN where there is no hit, or more than one.
  [[nodiscard]] float at(std::int64_t column, std::int64_t row) const noexcept {
    return has(column, row) ? depths_[place(column, row)] : missing;
  }

 private:
  static constexpr double infinity = std::numeric_limits<double>::infinity();
  static constexpr float missing = std::numeric_limits<float>::quiet_NaN();
  const SupportPlane& plane_;
  const PlaneChart& chart_;
  double step_;
  std::vector<float> depths_;

  [[nodiscard]] bool has(std::int64_t column, std::int64_t row) const noexcept {
    return column >= 0 && row >= 0 && column < columns && row < rows;
  }
  [[nodiscard]] std::size_t place(std::int64_t column, std::int64_t row) const noexcept {
    return static_cast<std::size_t>(row) * columns + static_cast<std::size_t>(column);
  }
  void add(const std::array<Vector3, 3>& corners);
  /// Makes room on all sides.
  void widen(std::uint32_t by);
  /// Keeps a depth at a place.
  void keep(std::size_t place, double depth) noexcept;
};

}  // namespace spm::baker
