// SPDX-License-Identifier: GPL-3.0-or-later
#include "baker/charts/chart_field.hpp"

#include <Eigen/Dense>
#include <algorithm>
#include <array>
#include <cmath>

namespace spm::baker {

namespace {

/// Of what a query computes in floats, and of the place on the lattice, in spacings.
constexpr double float_rounding = 2e-6, lattice_rounding = 1e-6;
/// Of a leaf's own heights, so that no part of it asks for others.
constexpr double leaf_rounding = 2e-6;

std::int64_t nearest(double x) { return static_cast<std::int64_t>(std::floor(x + 0.5)); }

/// The least and the largest of numbers.
struct Span {
  double low = 0, high = 0;
  bool any = false;
  void meet(double x) {
    low = any ? std::min(low, x) : x;
    high = any ? std::max(high, x) : x;
    any = true;
  }
  [[nodiscard]] double middle() const { return (low + high) / 2; }
  [[nodiscard]] double half() const { return (high - low) / 2; }
  [[nodiscard]] double most() const { return std::max(std::abs(low), std::abs(high)); }
};

/// Of a cell of the lattice, the part over which a cube lies: from its middle, in [-0.5, 0.5].
struct Part {
  double low, high;
  Part(double middle, double half, std::int64_t cell)
      : low(std::max(-0.5, middle - half - static_cast<double>(cell))),
        high(std::min(0.5, middle + half - static_cast<double>(cell))) {}
};

double blend(const std::array<double, 3>& of, double t) {
  return 0.5 * (0.5 - t) * (0.5 - t) * of[0] + (0.75 - t * t) * of[1] +
         0.5 * (0.5 + t) * (0.5 + t) * of[2];
}
double derivative(const std::array<double, 3>& of, double t) {
  return (t - 0.5) * of[0] - 2 * t * of[1] + (t + 0.5) * of[2];
}

double second(const std::array<double, 3>& of) { return of[0] - 2 * of[1] + of[2]; }

/// All values between two places. Between its ends a quadratic leaves them by no more than an
/// eighth of its second derivative.
void meet_blend(const std::array<double, 3>& of, const Part& part, Span& span) {
  const double at_low = blend(of, part.low), at_high = blend(of, part.high);
  const double way = part.high - part.low;
  const double bulge = std::abs(second(of)) * way * way / 8;
  span.meet(std::min(at_low, at_high) - bulge);
  span.meet(std::max(at_low, at_high) + bulge);
}

/// The derivatives along rows there, one for each of three rows.
std::array<double, 3> slopes(const std::array<std::array<double, 3>, 3>& h, double s) {
  return {derivative(h[0], s), derivative(h[1], s), derivative(h[2], s)};
}

}  // namespace

ChartField::ChartField(const ChartHeights& heights, const ChartAtLevel& map)
    : plane_(heights.plane(map.chart)),
      grid_(heights.of(map)),
      offset_(heights.offset(map)),
      per_(1 / grid_.spacing),
      across_{plane_.u.lpNorm<1>(), plane_.v.lpNorm<1>(), plane_.n.lpNorm<1>()} {}

ChartField::Place ChartField::place_of(const Vector3& point) const {
  const PlaneCoordinates at = project_on_plane(plane_, point);
  return {at.eta * per_ - grid_.column0, at.omega * per_ - grid_.row0,
          at.depth - static_cast<double>(grid_.base)};
}

HeightRange ChartField::range_over(const Vector3& middle, double half) const {
  const Place at = place_of(middle);
  const double wide = half * across_[0] / grid_.spacing + leaf_rounding;
  const double high = half * across_[1] / grid_.spacing + leaf_rounding;
  return {nearest(at.x - wide) - 1, nearest(at.x + wide) + 1, nearest(at.y - high) - 1,
          nearest(at.y + high) + 1};
}

bool ChartField::covers(const Vector3& middle, double half) const {
  const HeightRange range = range_over(middle, half);
  if (range.column_from < 0 || range.row_from < 0 || range.column_to >= grid_.columns ||
      range.row_to >= grid_.rows) {
    return false;
  }
  for (std::int64_t row = range.row_from; row <= range.row_to; ++row) {
    for (std::int64_t column = range.column_from; column <= range.column_to; ++column) {
      if (std::isnan(grid_.at(column, row))) return false;
    }
  }
  return true;
}

ChartField::Window ChartField::window_at(std::int64_t column, std::int64_t row) const {
  Window heights{};
  for (std::size_t r = 0; r < 3; ++r) {
    for (std::size_t c = 0; c < 3; ++c) {
      heights[r][c] = static_cast<double>(grid_.at(column + static_cast<std::int64_t>(c) - 1,
                                                   row + static_cast<std::int64_t>(r) - 1));
    }
  }
  return heights;
}

ChartField::Spline ChartField::spline_at(double x, double y) const {
  const std::int64_t i = nearest(x), j = nearest(y);
  const double s = x - static_cast<double>(i), t = y - static_cast<double>(j);
  std::array<double, 3> values{}, along{};
  const Window heights = window_at(i, j);
  for (std::size_t r = 0; r < 3; ++r) {
    values[r] = blend(heights[r], s);
    along[r] = derivative(heights[r], s);
  }
  return {blend(values, t), blend(along, t), derivative(values, t)};
}

double ChartField::at(const Vector3& place, Vector3& normal) const {
  const Place at = place_of(place);
  const Spline spline = spline_at(at.x, at.y);
  const double eta = spline.by_x * per_, omega = spline.by_y * per_;
  normal = plane_.n + eta * plane_.u + omega * plane_.v;
  return offset_ + (spline.value - at.depth) / std::sqrt(1 + eta * eta + omega * omega);
}

// With F = D_SP - S_SP and w = 1 / |n_S| the field is w F. D_SP is quadratic within the lattice's
// cells, and its second derivatives jump between them: here they are a constant, and how far they
// are from that. w is a function of the slope of D_SP, expanded up to its second derivative.
FieldBound ChartField::about(const Vector3& middle, double half) const {
  const Place at = place_of(middle);
  const Spline spline = spline_at(at.x, at.y);
  const double per = per_;
  const double along_eta = half * across_[0], along_omega = half * across_[1],
               along_depth = half * across_[2];
  // Second derivatives in all cells that the cube's projection meets.
  const double wide = along_eta * per + lattice_rounding,
               high = along_omega * per + lattice_rounding;
  const std::int64_t i0 = nearest(at.x - wide), i1 = nearest(at.x + wide);
  const std::int64_t j0 = nearest(at.y - high), j1 = nearest(at.y + high);
  Span xx, xy, yy;
  double most = 0;
  for (std::int64_t j = j0; j <= j1; ++j) {
    const Part t(at.y, high, j);
    for (std::int64_t i = i0; i <= i1; ++i) {
      const Part u(at.x, wide, i);
      const Window h = window_at(i, j);
      for (const auto& row : h) {
        for (const double height : row) most = std::max(most, std::abs(height - h[1][1]));
      }
      std::array<double, 3> bend_x{}, bend_y{};
      for (std::size_t k = 0; k < 3; ++k) {
        bend_x[k] = second(h[k]);
        bend_y[k] = second({h[0][k], h[1][k], h[2][k]});
      }
      meet_blend(bend_x, t, xx);
      meet_blend(bend_y, u, yy);
      const std::array<double, 3> slope_low = slopes(h, u.low), slope_high = slopes(h, u.high);
      for (const auto& slope : {slope_low, slope_high}) {
        xy.meet(derivative(slope, t.low));
        xy.meet(derivative(slope, t.high));
      }
    }
  }
  // The middles of these ranges serve as well as what is at the middle of the cube.
  const double scale = per * per;
  const double d_xx = scale * xx.middle(), d_xy = scale * xy.middle(), d_yy = scale * yy.middle();
  const double spread_xx = scale * xx.half(), spread_xy = scale * xy.half(),
               spread_yy = scale * yy.half();
  const double most_xx = scale * xx.most(), most_xy = scale * xy.most(),
               most_yy = scale * yy.most();

  using Pair = Eigen::Vector2d;
  const Pair slope(spline.by_x * per, spline.by_y * per);
  const Pair way(along_eta, along_omega);
  Eigen::Matrix2d d2, spread, most_bent;
  d2 << d_xx, d_xy, d_xy, d_yy;
  spread << spread_xx, spread_xy, spread_xy, spread_yy;
  most_bent << most_xx, most_xy, most_xy, most_yy;
  const double w = 1 / std::sqrt(1 + slope.squaredNorm()), w3 = w * w * w;
  const double field = spline.value - at.depth;
  // D_SP is slope . d + d' d2 d / 2 to within d_off, its slope is slope + d2 d to within `wrong`.
  const double d_off = 0.5 * way.dot(spread * way);
  const Pair wrong = spread * way, turns = d2.cwiseAbs() * way;
  const Pair slope_most = slope.cwiseAbs() + most_bent * way;
  const double field_changes = slope_most.dot(way) + along_depth;
  // w is w0 + w1 . d + d' w2 d / 2 to within w_off: its derivative by the slope is shorter than
  // the slope, its third one than 2.6.
  const Pair turned = d2 * slope;
  const Pair w1 = -w3 * turned;
  const Eigen::Matrix2d w2 = -w3 * (d2 * d2) + 3 * w3 * w * w * (turned * turned.transpose());
  const double turn = turns.norm();
  const double w_off = slope_most.dot(wrong) + 2.6 / 6 * turn * turn * turn;
  FieldBound bound;
  bound.off = w * d_off + w_off * (std::abs(field) + field_changes) +
              0.5 * turn * turn * field_changes +
              w1.cwiseAbs().dot(way) * (0.5 * way.dot(most_bent * way)) +
              float_rounding * most * (1 + (std::abs(field) + field_changes) * per);
  Eigen::Matrix3d axes, bend = Eigen::Matrix3d::Zero();
  axes << plane_.u.transpose(), plane_.v.transpose(), -plane_.n.transpose();
  bend.topLeftCorner<2, 2>() =
      0.5 * (w * d2 + field * w2 + w1 * slope.transpose() + slope * w1.transpose());
  bend.topRightCorner<2, 1>() = -0.5 * w1;
  bend.bottomLeftCorner<1, 2>() = -0.5 * w1.transpose();
  bound.near.middle = middle;
  bound.near.value = offset_ + w * field;
  bound.near.gradient =
      axes.transpose() * Vector3(w * slope[0] + w1[0] * field, w * slope[1] + w1[1] * field, -w);
  bound.near.bend = axes.transpose() * bend * axes;
  bound.normal = w * (plane_.n + slope[0] * plane_.u + slope[1] * plane_.v);
  bound.turn = (most_bent * way).norm() + float_rounding * (1 + most * per);
  return bound;
}

}  // namespace spm::baker
