// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <bit>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <cstring>

#include "common/base/vector.hpp"
#include "common/surface/stored_heights.hpp"
#include "common/surface/support_plane.hpp"

namespace spm {

/// A chart of a `sparse` asset: the distance map (eq. 2) of one connected piece of the surface, or
/// of its offset surface, as one support plane sees it. A view that owns nothing.
///
/// The height of column i and row j belongs to the plane's point (eq. 1) at eta = (column0 + i)
/// spacing, omega = (row0 + j) spacing: metres below the chart's base, along the plane's normal,
/// samples that are read in place. They are the coefficients of a biquadratic B-spline, which is
/// D_SP less the base.
struct alignas(64) HeightChart {
  /// A function that is linear in space: the scalar product with a place, and a number.
  struct Linear {
    double x = 0, y = 0, z = 0, at_origin = 0;
    [[nodiscard]] double at(const Vector3& place) const noexcept {
      return x * place[0] + y * place[1] + z * place[2] + at_origin;
    }
  };
  Linear column, row;                   ///< of P_M, in spacings from the first height
  Linear depth;                         ///< S_SP less the base, m
  StoredHeights heights;                ///< from the first on; one more may be read behind the last
  std::uint32_t stride = 0;             ///< from one row to the next
  std::uint16_t columns = 0, rows = 0;  ///< 3 or more
  std::uint32_t plane = 0;              ///< row of the plane table
  /// m, 0 or less: the map is of the offset surface at that signed distance; 0: of the surface.
  float offset = 0;

  /// m, between neighbouring heights.
  [[nodiscard]] double spacing() const noexcept {
    return 1 / std::sqrt(column.x * column.x + column.y * column.y + column.z * column.z);
  }
};

/// A chart without heights on a plane, so many metres between them; the first one belongs to that
/// column and row. Heights count from `base`, m below the plane: 0 for FLOAT samples; HALF ones
/// tell small numbers more exactly.
[[nodiscard]] inline HeightChart chart_on(const SupportPlane& plane, double spacing, double column0,
                                          double row0, double base = 0) noexcept {
  const auto along = [&plane](const Vector3& axis, double scale, double at_origin) {
    return HeightChart::Linear{scale * axis[0], scale * axis[1], scale * axis[2],
                               at_origin - scale * axis.dot(plane.x0)};
  };
  const double per = 1 / spacing;
  HeightChart chart;
  chart.column = along(plane.u, per, -column0);
  chart.row = along(plane.v, per, -row0);
  chart.depth = along(-plane.n, 1, -base);
  return chart;
}

/// The point of a chart's plane (eq. 1) at a column and row, which need not be whole numbers.
[[nodiscard]] inline Vector3 chart_point(const HeightChart& chart, const SupportPlane& plane,
                                         double column, double row) noexcept {
  const double spacing = chart.spacing();
  return support_plane_point(plane, spacing * (column - chart.column.at(plane.x0)),
                             spacing * (row - chart.row.at(plane.x0)));
}

/// What a distance map tells of a place.
struct MapContact {
  double penetration = 0;            ///< S_SP - D_SP(P_M), m: eq. 3
  Vector3 normal = Vector3::Zero();  ///< n_S, not normalised: eq. 5
};

namespace height_chart {

using Four = float __attribute__((vector_size(16)));

/// The four heights from there on.
[[nodiscard]] inline Four load(const float* at) noexcept {
  Four four;
  std::memcpy(&four, at, sizeof four);
  return four;
}
[[nodiscard]] inline Four load(const std::uint16_t* at) noexcept {
  using Long = std::uint64_t __attribute__((vector_size(16)));
  using Halves = std::uint16_t __attribute__((vector_size(16)));
  using Lanes = std::uint32_t __attribute__((vector_size(16)));
  std::uint64_t four = 0;
  std::memcpy(&four, at, sizeof four);
  const auto halves = std::bit_cast<Halves>(Long{four, 0});
  const auto lanes =
      std::bit_cast<Lanes>(__builtin_shufflevector(halves, Halves{}, 0, 8, 1, 9, 2, 10, 3, 11));
  return std::bit_cast<Four>((lanes << half_shift) + half_exponent);
}

/// Weights of three heights in a row for the value between them, and for the derivative by column
/// or row, at `t` from the middle one, in [-0.5, 0.5].
struct Weights {
  Four value{}, slope{};
  Weights() = default;
  explicit Weights(float t) noexcept {
    const Four at = Four{-0.5F, 0, 0.5F, 0} + t;
    value = at * at * Four{0.5F, -1, 0.5F, 0} + Four{0, 0.75F, 0, 0};
    slope = at * Four{1, -2, 1, 0};
  }
};

[[nodiscard]] inline float sum(Four x) noexcept { return (x[0] + x[1]) + x[2]; }

struct Sums {
  double first, second;
};

/// The sums of two.
[[nodiscard]] inline Sums sums(Four a, Four b) noexcept {
  const Four low = __builtin_shufflevector(a, b, 0, 4, 1, 5);
  const Four all = (low + __builtin_shufflevector(low, low, 2, 3, 2, 3)) +
                   __builtin_shufflevector(a, b, 2, 6, 2, 6);
  return {static_cast<double>(all[0]), static_cast<double>(all[1])};
}

}  // namespace height_chart

/// The nine heights about a place's projection, and where that lies between them.
struct HeightStencil {
  float height = 0;  ///< the one in the middle, m
  /// Rows of all less that, which keeps what follows as exact as floats can; the fourth lane does
  /// not count.
  height_chart::Four before{}, middle{}, after{};
  height_chart::Weights across, along;

  /// Reads the rows, from the one of a place on.
  template <class Sample>
  void read(const Sample* first, std::size_t stride) noexcept {
    before = height_chart::load(first);
    middle = height_chart::load(first + stride);
    after = height_chart::load(first + 2 * stride);
    height = middle[1];
    before -= height;
    middle -= height;
    after -= height;
  }

  /// The rows with weights for each of them.
  [[nodiscard]] height_chart::Four blend(height_chart::Four weights) const noexcept {
    return weights[0] * before + weights[1] * middle + weights[2] * after;
  }
};

/// The stencil of a place. False where its projection P_M is not on the chart.
[[nodiscard]] inline bool stencil_at(const HeightChart& chart, const Vector3& place,
                                     HeightStencil& stencil) noexcept {
  const double from_first = chart.column.at(place), from_top = chart.row.at(place);
  const double column = from_first + 0.5, row = from_top + 0.5;
  // Written so that NaN is not on it.
  if (!(column >= 1 && row >= 1 && column < chart.columns - 1 && row < chart.rows - 1))
    return false;
  const auto i = static_cast<std::int32_t>(column), j = static_cast<std::int32_t>(row);
  const std::size_t first =
      static_cast<std::size_t>(j - 1) * chart.stride + static_cast<std::size_t>(i - 1);
  if (chart.heights.halves) {
    stencil.read(chart.heights.half_at(first), chart.stride);
  } else {
    stencil.read(chart.heights.float_at(first), chart.stride);
  }
  stencil.across = height_chart::Weights(static_cast<float>(from_first - i));
  stencil.along = height_chart::Weights(static_cast<float>(from_top - j));
  return true;
}

/// Eq. 3 to 5 on a chart. False where the place's projection P_M is not on it.
[[nodiscard, gnu::always_inline]] inline bool contact_on(const HeightChart& chart,
                                                         const Vector3& place,
                                                         MapContact& contact) noexcept {
  using height_chart::Four;
  HeightStencil at;
  if (!stencil_at(chart, place, at)) return false;
  const Four values = at.blend(at.along.value), slopes = at.blend(at.along.slope);
  // The height and its slope by column in two lanes, that by row in a third.
  const auto [height_beside, by_column] =
      height_chart::sums(values * at.across.value, values * at.across.slope);
  const double height = static_cast<double>(at.height) + height_beside;
  const auto by_row = static_cast<double>(height_chart::sum(slopes * at.across.value));
  contact.penetration = chart.depth.at(place) - height;
  contact.normal = {by_column * chart.column.x + by_row * chart.row.x - chart.depth.x,
                    by_column * chart.column.y + by_row * chart.row.y - chart.depth.y,
                    by_column * chart.column.z + by_row * chart.row.z - chart.depth.z};
  return true;
}

/// 1/m: the trace of the second derivatives of the signed distance that a chart tells, at the
/// surface over a place; 0 where its projection is not on the chart.
[[nodiscard]] inline double bend_on(const HeightChart& chart, const Vector3& place) noexcept {
  using height_chart::Four;
  HeightStencil at;
  MapContact contact;
  if (!stencil_at(chart, place, at) || !contact_on(chart, place, contact)) return 0;
  const Four values = at.blend(at.along.value), slopes = at.blend(at.along.slope);
  const Four bends = at.before - 2 * at.middle + at.after;
  const Vector3 u(chart.column.x, chart.column.y, chart.column.z);
  const Vector3 v(chart.row.x, chart.row.y, chart.row.z);
  const double per_square = u.squaredNorm();  // of a spacing
  const double by_eta_eta = per_square * static_cast<double>(values[0] - 2 * values[1] + values[2]);
  const double by_omega_omega =
      per_square * static_cast<double>(height_chart::sum(bends * at.across.value));
  const double by_eta_omega =
      per_square * static_cast<double>(height_chart::sum(slopes * at.across.slope));
  // n_S along u and v is the slope of D_SP.
  const double spacings = std::sqrt(per_square);
  const double eta = contact.normal.dot(u) / spacings, omega = contact.normal.dot(v) / spacings;
  const double per = 1 / contact.normal.norm();
  return per * (by_eta_eta + by_omega_omega) -
         2 * per * per * per *
             (eta * eta * by_eta_eta + 2 * eta * omega * by_eta_omega +
              omega * omega * by_omega_omega);
}

}  // namespace spm
