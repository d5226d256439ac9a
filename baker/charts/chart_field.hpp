// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <algorithm>
#include <array>
#include <cstdint>

#include "baker/charts/bounded_field.hpp"
#include "baker/charts/chart_heights.hpp"

namespace spm::baker {

/// A range of heights on a grid: columns and rows, with both ends.
struct HeightRange {
  std::int64_t column_from = 0, column_to = -1, row_from = 0, row_to = -1;

  [[nodiscard]] std::uint64_t count() const noexcept {
    return static_cast<std::uint64_t>((column_to - column_from + 1) * (row_to - row_from + 1));
  }
  [[nodiscard]] bool has(std::int64_t column, std::int64_t row) const noexcept {
    return column >= column_from && column <= column_to && row >= row_from && row <= row_to;
  }
  /// Grows over another one.
  void meet(const HeightRange& other) noexcept {
    if (column_to < column_from) *this = other;
    column_from = std::min(column_from, other.column_from);
    column_to = std::max(column_to, other.column_to);
    row_from = std::min(row_from, other.row_from);
    row_to = std::max(row_to, other.row_to);
  }
};

/// The signed distance that a chart tells (contact_on over the length of n_S), and bounds of it.
class ChartField : public BoundedField {
 public:
  ChartField(const ChartHeights& heights, const ChartAtLevel& map);

  /// Whether all heights are there from which places of a cube are answered.
  [[nodiscard]] bool covers(const Vector3& middle, double half) const;
  /// These heights.
  [[nodiscard]] HeightRange range_over(const Vector3& middle, double half) const;
  /// The signed distance at a place, m, and its direction n_S, of no certain length. The place must
  /// be covered.
  [[nodiscard]] double at(const Vector3& place, Vector3& normal) const;
  [[nodiscard]] FieldBound about(const Vector3& middle, double half) const override;

 private:
  const SupportPlane& plane_;
  const HeightGrid& grid_;
  double offset_;                 ///< m, of what the chart is of
  double per_;                    ///< 1/m, of the spacing
  std::array<double, 3> across_;  ///< of half a cube's edge, its box along u, v and n

  struct Spline {
    double value = 0, by_x = 0, by_y = 0;
  };
  using Window = std::array<std::array<double, 3>, 3>;  ///< heights, m, row by row
  struct Place {
    double x = 0, y = 0, depth = 0;  ///< in spacings of the grid; m below the base
  };
  [[nodiscard]] Place place_of(const Vector3& point) const;
  /// The heights about one of them.
  [[nodiscard]] Window window_at(std::int64_t column, std::int64_t row) const;
  /// Heights and derivatives, m and spacings.
  [[nodiscard]] Spline spline_at(double x, double y) const;
};

}  // namespace spm::baker
