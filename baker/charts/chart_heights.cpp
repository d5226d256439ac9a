// SPDX-License-Identifier: GPL-3.0-or-later
#include "baker/charts/chart_heights.hpp"

#include <Eigen/Dense>
#include <algorithm>
#include <array>
#include <cmath>
#include <limits>

#include "common/base/half.hpp"

namespace spm::baker {

namespace {

constexpr float missing = std::numeric_limits<float>::quiet_NaN();
/// Two hits of one ray are one where they differ by less than this share of the spacing.
constexpr double same_hit = 0.02;
/// Hits on each side of a height, at half the spacing: one spacing, and where few are there two, or
/// four.
constexpr int near_hits = 2, far_hits = 4, last_hits = 8;
constexpr std::size_t near_side = 2 * near_hits + 1;
constexpr int unknowns = 6;
/// Weight with which bending is drawn to 0 where hits do not tell it, near and far from them.
constexpr double ridge = 1e-3, last_ridge = 1;
constexpr std::uint32_t max_hits = 1U << 26U;

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

/// A chart's box on its plane, in steps.
struct ChartBox {
  std::array<double, 2> low{}, high{};
};

ChartBox box_of(const OuterSurface& surface, const SupportPlane& plane, const PlaneChart& chart,
                double step) {
  constexpr double far = std::numeric_limits<double>::infinity();
  ChartBox box{{far, far}, {-far, -far}};
  for (const std::uint32_t t : chart.triangles) {
    for (const std::uint32_t v : surface.triangles[t]) {
      const PlaneCoordinates at = project_on_plane(plane, surface.vertices[v]);
      const std::array<double, 2> place{at.eta / step, at.omega / step};
      for (std::size_t k = 0; k < 2; ++k) {
        box.low[k] = std::min(box.low[k], place[k]);
        box.high[k] = std::max(box.high[k], place[k]);
      }
    }
  }
  return box;
}

/// Where rays along a plane's normal meet a chart: depths below the plane, m.
class Hits {
 public:
  Hits(const OuterSurface& surface, const SupportPlane& plane, const PlaneChart& chart, double step)
      : surface_(surface), plane_(plane), step_(step) {
    const auto [low, high] = box_of(surface, plane, chart, step);
    // From an even one on, which a height lies at.
    const auto start = [](double x) { return 2 * static_cast<std::int32_t>(std::floor(x / 2)); };
    column0 = start(low[0]);
    row0 = start(low[1]);
    columns = static_cast<std::uint32_t>(std::ceil(high[0]) - column0) + 1;
    rows = static_cast<std::uint32_t>(std::ceil(high[1]) - row0) + 1;
    if (std::uint64_t{columns} * rows > max_hits) {
      columns = rows = 0;
      return;
    }
    depths_.assign(std::size_t{columns} * rows, missing);
    for (const std::uint32_t t : chart.triangles) add(surface.triangles[t]);
    for (float& depth : depths_) {
      if (std::isinf(depth)) depth = missing;
      if (std::isnan(depth)) continue;
      least = std::min(least, static_cast<double>(depth));
      most = std::max(most, static_cast<double>(depth));
    }
  }

  std::int32_t column0 = 0, row0 = 0;
  std::uint32_t columns = 0, rows = 0;
  double least = std::numeric_limits<double>::infinity(), most = -least;  ///< of all, m

  /// NaN where there is none, or more than one.
  [[nodiscard]] float at(std::int64_t column, std::int64_t row) const {
    if (column < 0 || row < 0 || column >= columns || row >= rows) return missing;
    return depths_[static_cast<std::size_t>(row) * columns + static_cast<std::size_t>(column)];
  }

 private:
  const OuterSurface& surface_;
  const SupportPlane& plane_;
  double step_;
  std::vector<float> depths_;

  void add(const Triangle& triangle) {
    constexpr double slack = 1e-9;
    std::array<std::array<double, 3>, 3> at{};  // column, row, depth
    for (std::size_t k = 0; k < 3; ++k) {
      const PlaneCoordinates place = project_on_plane(plane_, surface_.vertices[triangle[k]]);
      at[k] = {place.eta / step_ - column0, place.omega / step_ - row0, place.depth};
    }
    const double x1 = at[1][0] - at[0][0], y1 = at[1][1] - at[0][1], z1 = at[1][2] - at[0][2];
    const double x2 = at[2][0] - at[0][0], y2 = at[2][1] - at[0][1], z2 = at[2][2] - at[0][2];
    const double twice = x1 * y2 - x2 * y1;
    if (!(std::abs(twice) > 1e-12)) return;
    const double by_x = (z1 * y2 - z2 * y1) / twice, by_y = (x1 * z2 - x2 * z1) / twice;
    const auto [low, high] = std::minmax({at[0][1], at[1][1], at[2][1]});
    const auto from = static_cast<std::int64_t>(std::ceil(low - slack));
    const auto to = static_cast<std::int64_t>(std::floor(high + slack));
    for (std::int64_t row = std::max<std::int64_t>(from, 0);
         row <= std::min<std::int64_t>(to, std::int64_t{rows} - 1); ++row) {
      const auto y = static_cast<double>(row);
      double left = std::numeric_limits<double>::infinity(), right = -left;
      for (std::size_t k = 0; k < 3; ++k) {
        const auto &a = at[k], &b = at[(k + 1) % 3];
        if (std::max(a[1], b[1]) < y - slack || std::min(a[1], b[1]) > y + slack) continue;
        const double rise = b[1] - a[1];
        if (std::abs(rise) < slack) {
          left = std::min({left, a[0], b[0]});
          right = std::max({right, a[0], b[0]});
          continue;
        }
        const double share = std::clamp((y - a[1]) / rise, 0.0, 1.0);
        const double x = a[0] + share * (b[0] - a[0]);
        left = std::min(left, x);
        right = std::max(right, x);
      }
      const auto first = static_cast<std::int64_t>(std::ceil(left - slack));
      const auto last = static_cast<std::int64_t>(std::floor(right + slack));
      for (std::int64_t column = std::max<std::int64_t>(first, 0);
           column <= std::min<std::int64_t>(last, std::int64_t{columns} - 1); ++column) {
        const double depth =
            at[0][2] + by_x * (static_cast<double>(column) - at[0][0]) + by_y * (y - at[0][1]);
        float& known =
            depths_[static_cast<std::size_t>(row) * columns + static_cast<std::size_t>(column)];
        if (std::isnan(known)) {
          known = static_cast<float>(depth);
        } else if (!(std::abs(static_cast<double>(known) - depth) < same_hit * step_)) {
          known = std::numeric_limits<float>::infinity();
        }
      }
    }
  }
};

/// Whether hits lie in more than one line, so that they tell both slopes: by the sums of their
/// terms.
bool is_wide(const Square& sums) {
  constexpr double least_spread = 0.03;  // spacings squared: less than two lines have
  const double count = sums(0, 0), x = sums(0, 1) / count, y = sums(0, 2) / count;
  const double xx = sums(0, 3) / count - x * x, yy = sums(0, 4) / count - y * y,
               xy = sums(0, 5) / count - x * y;
  return (xx + yy) / 2 - std::hypot((xx - yy) / 2, xy) > least_spread;
}

/// Makes heights of hits.
class Filter {
 public:
  explicit Filter(const Hits& hits) : hits_(hits) {}

  /// The coefficient at a hit's place; NaN where too few hits are around it.
  [[nodiscard]] double at(std::int64_t column, std::int64_t row) const {
    double sum = 0;
    std::size_t found = 0;
    std::size_t which = 0;
    for (int j = -near_hits; j <= near_hits; ++j) {
      for (int i = -near_hits; i <= near_hits; ++i, ++which) {
        const float hit = hits_.at(column + i, row + j);
        if (std::isnan(hit)) continue;
        sum += filter_[which] * static_cast<double>(hit);
        ++found;
      }
    }
    if (found == near_side * near_side) return sum;
    if (found > near_side * near_side / 2) return fitted(column, row, near_hits, ridge);
    const double height = fitted(column, row, far_hits, ridge);
    return std::isnan(height) ? fitted(column, row, last_hits, last_ridge) : height;
  }

 private:
  const Hits& hits_;
  inline static const std::array<double, near_side* near_side> filter_ = whole_filter();

  [[nodiscard]] double fitted(std::int64_t column, std::int64_t row, int reach,
                              double bending) const {
    Square normal = Square::Zero();
    Column right = Column::Zero();
    int found = 0;
    for (int j = -reach; j <= reach; ++j) {
      for (int i = -reach; i <= reach; ++i) {
        const float hit = hits_.at(column + i, row + j);
        if (std::isnan(hit)) continue;
        const Row terms_here = terms(0.5 * i, 0.5 * j);
        normal += terms_here.transpose() * terms_here;
        right += terms_here.transpose() * static_cast<double>(hit);
        ++found;
      }
    }
    if (found < unknowns || !is_wide(normal)) return std::numeric_limits<double>::quiet_NaN();
    for (int k = 3; k < unknowns; ++k) normal(k, k) += bending * found;
    for (int k = 1; k < 3; ++k) normal(k, k) += 1e-9 * found;
    return coefficient().dot(normal.ldlt().solve(right));
  }
};

/// The plane that is nearest to heights, m below the support plane, in the mean of squares: so far
/// down that all heights above it are least_half and more. NaN are none.
ChartBase base_of(const HeightGrid& grid, const std::vector<double>& heights) {
  Eigen::Matrix3d normal = Eigen::Matrix3d::Zero();
  Vector3 right = Vector3::Zero();
  const auto visit = [&](const auto& of) {
    for (std::size_t i = 0; i < heights.size(); ++i) {
      if (std::isnan(heights[i])) continue;
      of(grid.eta(i % grid.columns), grid.omega(i / grid.columns), heights[i]);
    }
  };
  visit([&](double eta, double omega, double height) {
    const Vector3 row(1, eta / grid.spacing, omega / grid.spacing);
    normal += row * row.transpose();
    right += height * row;
  });
  if (!(normal(0, 0) > 0)) return {};
  for (int k = 1; k < 3; ++k) normal(k, k) += 1e-9 * normal(0, 0);
  const Vector3 solved = normal.ldlt().solve(right);
  ChartBase base{0, static_cast<float>(solved[1] / grid.spacing),
                 static_cast<float>(solved[2] / grid.spacing)};
  double least = std::numeric_limits<double>::infinity();
  visit([&](double eta, double omega, double height) {
    least = std::min(least, height - base.at(eta, omega));
  });
  constexpr auto room = static_cast<double>(least_half);
  base.depth = static_cast<float>(least - room);
  while (least - static_cast<double>(base.depth) < room) {
    base.depth = std::nextafter(base.depth, -std::numeric_limits<float>::infinity());
  }
  return base;
}

/// Stores heights, m below the plane, in their grid.
void store(const std::vector<double>& heights, bool halves, HeightGrid& grid) {
  grid.base = base_of(grid, heights);
  grid.heights.reserve(heights.size());
  for (std::size_t i = 0; i < heights.size(); ++i) {
    const auto height = static_cast<float>(
        heights[i] - grid.base.at(grid.eta(i % grid.columns), grid.omega(i / grid.columns)));
    if (!halves) {
      grid.heights.push_back(height);
    } else {
      grid.heights.push_back(height <= largest_half ? float_of_half(half_of(height)) : missing);
    }
  }
}

HeightGrid make_grid(const OuterSurface& surface, const SupportPlane& plane,
                     const PlaneChart& chart, double spacing, bool halves) {
  const Hits hits(surface, plane, chart, spacing / 2);
  HeightGrid grid;
  grid.spacing = spacing;
  if (hits.columns == 0) return grid;
  constexpr std::int32_t border = last_hits / 2;
  grid.column0 = hits.column0 / 2 - border;
  grid.row0 = hits.row0 / 2 - border;
  grid.columns = hits.columns / 2 + 1 + 2 * border;
  grid.rows = hits.rows / 2 + 1 + 2 * border;
  std::vector<double> heights;
  heights.reserve(std::size_t{grid.columns} * grid.rows);
  // Past the border heights are no farther from those of the hits than planes may be inclined.
  const double around = last_hits * spacing;
  const double low = hits.least - around, high = hits.most + around;
  const Filter filter(hits);
  for (std::int64_t row = 0; row < grid.rows; ++row) {
    for (std::int64_t column = 0; column < grid.columns; ++column) {
      const double height = filter.at(2 * (column - border), 2 * (row - border));
      heights.push_back(height > low && height < high ? height
                                                      : std::numeric_limits<double>::quiet_NaN());
    }
  }
  store(heights, halves, grid);
  return grid;
}

}  // namespace

ChartHeights::ChartHeights(const OuterSurface& surface, std::span<const SupportPlane> planes,
                           const PlaneCharts& charts, const MapSampling& sampling)
    : surface_(surface),
      planes_(planes),
      charts_(charts),
      sampling_(sampling),
      flat_(charts.charts().size()),
      slots_(std::make_unique<Slot[]>(charts.charts().size() * sampling.levels)) {
  for (std::size_t i = 0; i < flat_.size(); ++i) flat_[i] = flat_of(charts.charts()[i]);
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

HeightGrid ChartHeights::flat_grid(std::uint32_t chart, double spacing) const {
  constexpr std::int32_t border = 3;
  const PlaneChart& known = charts_.charts()[chart];
  const FlatChart& flat = flat_[chart];
  const auto [low, high] = box_of(surface_, planes_[known.plane], known, spacing);
  HeightGrid grid;
  grid.spacing = spacing;
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

const HeightGrid& ChartHeights::of(std::uint32_t chart, std::uint32_t level) const {
  Slot& slot = slots_[std::size_t{chart} * sampling_.levels + level];
  std::call_once(slot.once, [&] {
    const PlaneChart& known = charts_.charts()[chart];
    slot.grid = flat_[chart].is ? flat_grid(chart, spacing(level))
                                : make_grid(surface_, planes_[known.plane], known, spacing(level),
                                            sampling_.halves);
  });
  return slot.grid;
}

}  // namespace spm::baker
