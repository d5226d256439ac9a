// SPDX-License-Identifier: GPL-3.0-or-later
#include "baker/charts/chart_heights.hpp"

#include <Eigen/Dense>
#include <algorithm>
#include <array>
#include <cmath>
#include <limits>

#include "baker/charts/chart_hits.hpp"
#include "common/base/half.hpp"

namespace spm::baker {

namespace {

/// Where more of the surface is flat, heights are FLOAT samples.
constexpr double most_flat_of_halves = 0.1;
/// Hits on each side of a height, at half the spacing: one spacing, and where few are there two, or
/// four.
constexpr int near_hits = 2, far_hits = 4, last_hits = 8;
constexpr std::size_t near_side = 2 * near_hits + 1;
constexpr int unknowns = 6;
/// Weight with which bending is drawn to 0 where hits do not tell it, near and far from them.
constexpr double ridge = 1e-3, last_ridge = 1;

using Row = Eigen::Matrix<double, 1, unknowns>;
using Square = Eigen::Matrix<double, unknowns, unknowns>;
using Column = Eigen::Matrix<double, unknowns, 1>;

/// In spacings.
Row terms(double x, double y) {
  Row row;
  row << 1, x, y, x * x, y * y, x * y;
  return row;
}

/// The biquadratic B-spline's coefficient of a quadratic: its value less a quarter of both bends.
Column coefficient() {
  Column of;
  of << 1, 0, 0, -0.25, -0.25, 0;
  return of;
}

/// What each of the hits near a height counts for where all of them are there.
std::array<double, near_side * near_side> whole_filter() {
  Square normal = Square::Zero();
  for (int j = -near_hits; j <= near_hits; ++j) {
    for (int i = -near_hits; i <= near_hits; ++i) {
      const Row row = terms(0.5 * i, 0.5 * j);
      normal += row.transpose() * row;
    }
  }
  const Column solved = normal.ldlt().solve(coefficient());
  std::array<double, near_side * near_side> filter{};
  std::size_t at = 0;
  for (int j = -near_hits; j <= near_hits; ++j) {
    for (int i = -near_hits; i <= near_hits; ++i) filter[at++] = terms(0.5 * i, 0.5 * j) * solved;
  }
  return filter;
}

/// Whether hits lie in more than one line, so that they tell both slopes: by the sums of their
/// terms.
bool is_wide(const Square& sums) {
  constexpr double least_spread = 0.03;  // spacings squared: less than two lines have
  const double count = sums(0, 0), x = sums(0, 1) / count, y = sums(0, 2) / count;
  const double xx = sums(0, 3) / count - x * x, yy = sums(0, 4) / count - y * y,
               xy = sums(0, 5) / count - x * y;
  return (xx + yy) / 2 - std::hypot((xx - yy) / 2, xy) > least_spread;
}

/// Powers of the terms: unknown k is x to the first, y to the second of these.
constexpr std::array<std::array<std::size_t, 2>, unknowns> powers{
    {{0, 0}, {1, 0}, {0, 1}, {2, 0}, {0, 2}, {1, 1}}};
/// What two terms make: all x^a y^b with a + b of no more than 4. Kept for each place of a hit.
constexpr std::size_t moment_count = 15, last_side = std::size_t{2} * last_hits + 1;
using Moments = Eigen::Array<double, moment_count, 1>;
constexpr std::size_t moment(std::size_t a, std::size_t b) { return (a + b) * (a + b + 1) / 2 + b; }

std::vector<Moments> all_moments() {
  std::vector<Moments> all(last_side * last_side);
  for (int j = -last_hits, at = 0; j <= last_hits; ++j) {
    for (int i = -last_hits; i <= last_hits; ++i, ++at) {
      for (std::size_t a = 0; a <= 4; ++a) {
        for (std::size_t b = 0; a + b <= 4; ++b) {
          all[static_cast<std::size_t>(at)][static_cast<Eigen::Index>(moment(a, b))] =
              std::pow(0.5 * i, a) * std::pow(0.5 * j, b);
        }
      }
    }
  }
  return all;
}

/// How many hits there are around a place.
class HitCounts {
 public:
  explicit HitCounts(const ChartHits& hits)
      : columns_(hits.columns), rows_(hits.rows), above_left_((columns_ + 1) * (rows_ + 1), 0) {
    for (std::int64_t row = 0; row < rows_; ++row) {
      std::uint32_t in_row = 0;
      for (std::int64_t column = 0; column < columns_; ++column) {
        in_row += std::isnan(hits.at(column, row)) ? 0 : 1;
        above_left_[place(column + 1, row + 1)] = above_left_[place(column + 1, row)] + in_row;
      }
    }
  }
  /// No farther away than so many columns and rows.
  [[nodiscard]] std::uint32_t within(std::int64_t column, std::int64_t row, int reach) const {
    const auto from_column = std::clamp<std::int64_t>(column - reach, 0, columns_),
               to_column = std::clamp<std::int64_t>(column + reach + 1, 0, columns_),
               from_row = std::clamp<std::int64_t>(row - reach, 0, rows_),
               to_row = std::clamp<std::int64_t>(row + reach + 1, 0, rows_);
    return above_left_[place(to_column, to_row)] - above_left_[place(from_column, to_row)] -
           above_left_[place(to_column, from_row)] + above_left_[place(from_column, from_row)];
  }

 private:
  std::int64_t columns_, rows_;
  std::vector<std::uint32_t> above_left_;  ///< of all places before a column and a row

  [[nodiscard]] std::size_t place(std::int64_t column, std::int64_t row) const {
    return static_cast<std::size_t>(row * (columns_ + 1) + column);
  }
};

/// Makes heights of hits.
class Filter {
 public:
  explicit Filter(const ChartHits& hits) : hits_(hits), counts_(hits) {}

  /// The coefficient at a hit's place; NaN where too few hits are around it.
  [[nodiscard]] double at(std::int64_t column, std::int64_t row) const {
    const std::uint32_t found = counts_.within(column, row, near_hits);
    if (found == near_side * near_side) {
      double sum = 0;
      std::size_t which = 0;
      for (int j = -near_hits; j <= near_hits; ++j) {
        for (int i = -near_hits; i <= near_hits; ++i) {
          sum += filter_[which++] * static_cast<double>(hits_.at(column + i, row + j));
        }
      }
      return sum;
    }
    if (found > near_side * near_side / 2) return fitted(column, row, near_hits, ridge);
    const double height = fitted(column, row, far_hits, ridge);
    return std::isnan(height) ? fitted(column, row, last_hits, last_ridge) : height;
  }

 private:
  const ChartHits& hits_;
  HitCounts counts_;
  inline static const std::array<double, near_side* near_side> filter_ = whole_filter();
  inline static const std::vector<Moments> moments_ = all_moments();

  [[nodiscard]] double fitted(std::int64_t column, std::int64_t row, int reach,
                              double bending) const {
    const std::uint32_t found = counts_.within(column, row, reach);
    if (found < unknowns) return std::numeric_limits<double>::quiet_NaN();
    Moments sums = Moments::Zero();
    Column right = Column::Zero();
    for (int j = -reach; j <= reach; ++j) {
      for (int i = -reach; i <= reach; ++i) {
        const float hit = hits_.at(column + i, row + j);
        if (std::isnan(hit)) continue;
        sums += moments_[static_cast<std::size_t>(j + last_hits) * last_side +
                         static_cast<std::size_t>(i + last_hits)];
        right += terms(0.5 * i, 0.5 * j).transpose() * static_cast<double>(hit);
      }
    }
    Square normal;
    for (std::size_t r = 0; r < unknowns; ++r) {
      for (std::size_t c = 0; c < unknowns; ++c) {
        normal(static_cast<Eigen::Index>(r), static_cast<Eigen::Index>(c)) =
            sums[static_cast<Eigen::Index>(
                moment(powers[r][0] + powers[c][0], powers[r][1] + powers[c][1]))];
      }
    }
    if (!is_wide(normal)) return std::numeric_limits<double>::quiet_NaN();
    for (int k = 3; k < unknowns; ++k) normal(k, k) += bending * found;
    for (int k = 1; k < 3; ++k) normal(k, k) += 1e-9 * found;
    return coefficient().dot(normal.ldlt().solve(right));
  }
};

/// The depth below which all heights that HALF samples tell are least_half and more. NaN are none.
float base_of(const std::vector<double>& heights) {
  double least = std::numeric_limits<double>::infinity();
  for (const double height : heights) least = std::fmin(least, height);
  if (!std::isfinite(least)) return 0;
  constexpr auto room = static_cast<double>(least_half);
  auto base = static_cast<float>(least - room);
  while (least - static_cast<double>(base) < room) {
    base = std::nextafter(base, -std::numeric_limits<float>::infinity());
  }
  return base;
}

/// Stores heights, m below the plane, in their grid.
void store(const std::vector<double>& heights, bool halves, HeightGrid& grid) {
  if (halves) grid.base = base_of(heights);
  grid.heights.reserve(heights.size());
  for (const double depth : heights) {
    const auto height = static_cast<float>(depth - static_cast<double>(grid.base));
    if (!halves) {
      grid.heights.push_back(height);
    } else {
      grid.heights.push_back(height <= largest_half ? float_of_half(half_of(height))
                                                    : std::numeric_limits<float>::quiet_NaN());
    }
  }
}

}  // namespace

ChartHeights::ChartHeights(const Caster& caster, const OuterSurface& surface,
                           std::span<const SupportPlane> planes, const PlaneCharts& charts,
                           const MapSampling& sampling)
    : caster_(caster),
      surface_(surface),
      planes_(planes),
      charts_(charts),
      sampling_(sampling),
      flat_(charts.charts().size()),
      slots_(std::make_unique<Slot[]>(2 * charts.charts().size() * sampling.levels)) {
  double flat = 0, all = 0;  // m2
  for (std::size_t i = 0; i < flat_.size(); ++i) {
    const PlaneChart& chart = charts.charts()[i];
    flat_[i] = flat_of(chart);
    double area = 0;
    for (const std::uint32_t triangle : chart.triangles) area += caster.area(triangle);
    all += area;
    if (flat_[i].is) flat += area;
  }
  // FLOAT samples tell flat faces exactly, and these have few.
  if (flat > most_flat_of_halves * all) sampling_.halves = false;
}

ChartHeights::~ChartHeights() = default;

ChartHeights::FlatChart ChartHeights::flat_of(const PlaneChart& chart) const {
  Vector3 normal = Vector3::Zero();
  const auto corner = [this](std::uint32_t triangle, std::size_t k) -> const Vector3& {
    return surface_.vertices[surface_.triangles[triangle][k]];
  };
  for (const std::uint32_t t : chart.triangles) {
    normal += (corner(t, 1) - corner(t, 0)).cross(corner(t, 2) - corner(t, 0));
  }
  const double length = normal.norm();
  if (!(length > 0)) return {};
  normal /= length;
  const Vector3& start = corner(chart.triangles.front(), 0);
  for (const std::uint32_t t : chart.triangles) {
    for (std::size_t k = 0; k < 3; ++k) {
      if (std::abs(normal.dot(corner(t, k) - start)) > sampling_.flat_within) return {};
    }
  }
  const SupportPlane& plane = planes_[chart.plane];
  const double facing = normal.dot(plane.n);
  return {true, normal.dot(plane.x0 - start) / facing, normal.dot(plane.u) / facing,
          normal.dot(plane.v) / facing};
}

HeightGrid ChartHeights::flat_grid(const ChartAtLevel& map) const {
  constexpr std::int32_t border = 3;
  const FlatChart& flat = flat_[map.chart];
  HeightGrid grid;
  grid.spacing = spacing(map.level);
  const auto [low, high] =
      box_of(surface_, plane(map.chart), charts_.charts()[map.chart], grid.spacing);
  grid.column0 = static_cast<std::int32_t>(std::floor(low[0])) - border;
  grid.row0 = static_cast<std::int32_t>(std::floor(low[1])) - border;
  grid.columns = static_cast<std::uint32_t>(std::ceil(high[0]) - grid.column0 + border + 1);
  grid.rows = static_cast<std::uint32_t>(std::ceil(high[1]) - grid.row0 + border + 1);
  std::vector<double> heights;
  heights.reserve(std::size_t{grid.columns} * grid.rows);
  for (std::uint32_t row = 0; row < grid.rows; ++row) {
    for (std::uint32_t column = 0; column < grid.columns; ++column) {
      heights.push_back(flat.depth + flat.by_eta * grid.eta(column) +
                        flat.by_omega * grid.omega(row));
    }
  }
  store(heights, sampling_.halves, grid);
  return grid;
}

HeightGrid ChartHeights::curved_grid(const ChartAtLevel& map) const {
  HeightGrid grid;
  grid.spacing = spacing(map.level);
  ChartHits hits(surface_, plane(map.chart), charts_.charts()[map.chart], grid.spacing / 2);
  if (map.offset) hits.go_to_offset(caster_, sampling_.offset);
  if (hits.columns == 0) return grid;
  constexpr std::int32_t border = last_hits / 2;
  grid.column0 = hits.column0 / 2 - border;
  grid.row0 = hits.row0 / 2 - border;
  grid.columns = hits.columns / 2 + 1 + 2 * border;
  grid.rows = hits.rows / 2 + 1 + 2 * border;
  std::vector<double> heights;
  heights.reserve(std::size_t{grid.columns} * grid.rows);
  // Past the border heights are no farther from those of the hits than planes may be inclined.
  const double around = last_hits * grid.spacing;
  const double low = hits.least - around, high = hits.most + around;
  const Filter filter(hits);
  for (std::int64_t row = 0; row < grid.rows; ++row) {
    for (std::int64_t column = 0; column < grid.columns; ++column) {
      const double height = filter.at(2 * (column - border), 2 * (row - border));
      heights.push_back(height > low && height < high ? height
                                                      : std::numeric_limits<double>::quiet_NaN());
    }
  }
  store(heights, sampling_.halves, grid);
  return grid;
}

const HeightGrid& ChartHeights::of(const ChartAtLevel& map) const {
  const std::size_t row = 2 * std::size_t{map.chart} + (map.offset ? 1 : 0);
  Slot& slot = slots_[row * sampling_.levels + map.level];
  std::call_once(slot.once, [&] {
    slot.grid = flat_[map.chart].is && !map.offset ? flat_grid(map) : curved_grid(map);
  });
  return slot.grid;
}

}  // namespace spm::baker
