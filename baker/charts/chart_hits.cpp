// SPDX-License-Identifier: GPL-3.0-or-later
#include "baker/charts/chart_hits.hpp"

#include <algorithm>
#include <cmath>
#include <optional>
#include <utility>

namespace spm::baker {

namespace {

/// Two hits of one ray are one where they differ by less than this share of the step.
constexpr double same_hit = 0.02;
constexpr std::uint32_t max_hits = 1U << 26U;
/// An offset surface goes on without a crease from one ray to the next where the closest points of
/// the surface are no farther apart than so many steps.
constexpr double smooth_steps = 2;
/// What an offset surface faces the plane with at the least: the cosine of 66 degrees.
constexpr double facing_cosine = 0.4;
/// Newton's method along a ray: the steps that it may take, what it takes for 0 (m, of the
/// diagonal), and the least cosine with which a step is made longer.
constexpr int max_steps = 30;
constexpr double found_share = 1e-4, least_cosine = 0.5, lost_cosine = 0.1;

/// Where a ray along a plane's normal meets an offset surface.
struct OffsetHit {
  double depth = 0;  ///< m below the plane
  ClosestPoint closest;
};

/// From a depth nearby on. `near` is a point of the surface near the ray, if one is known.
std::optional<OffsetHit> meet_offset(const Caster& caster, double offset, const SupportPlane& plane,
                                     const Vector3& on_plane, double depth,
                                     std::optional<Vector3> near) {
  for (int k = 0; k < max_steps; ++k) {
    const Vector3 point = on_plane - depth * plane.n;
    const ClosestPoint closest =
        near ? caster.closest(point, (point - *near).norm()) : caster.closest(point);
    near = closest.closest_point;
    const double left = closest.distance - offset, facing = closest.direction.dot(plane.n);
    if (facing < lost_cosine) return std::nullopt;
    depth += left / std::max(facing, least_cosine);
    // The last step is off by less than its square over the radius of curvature.
    if (std::abs(left) < found_share * caster.diagonal()) {
      if (facing < facing_cosine) return std::nullopt;
      return OffsetHit{depth, closest};
    }
  }
  return std::nullopt;
}

}  // namespace

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

ChartHits::ChartHits(const OuterSurface& surface, const SupportPlane& plane,
                     const PlaneChart& chart, double step)
    : plane_(plane), chart_(chart), step_(step) {
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
  for (const std::uint32_t t : chart.triangles) {
    const Triangle& numbers = surface.triangles[t];
    add({surface.vertices[numbers[0]], surface.vertices[numbers[1]], surface.vertices[numbers[2]]});
  }
  for (std::size_t i = 0; i < depths_.size(); ++i) {
    if (std::isinf(depths_[i])) depths_[i] = missing;
    if (!std::isnan(depths_[i])) keep(i, static_cast<double>(depths_[i]));
  }
}

void ChartHits::keep(std::size_t place, double depth) noexcept {
  depths_[place] = static_cast<float>(depth);
  least = std::min(least, depth);
  most = std::max(most, depth);
}

void ChartHits::widen(std::uint32_t by) {
  std::vector<float> wider(std::size_t{columns + 2 * by} * (rows + 2 * by), missing);
  for (std::size_t row = 0; row < rows; ++row) {
    std::copy_n(depths_.begin() + static_cast<std::ptrdiff_t>(row * columns), columns,
                wider.begin() + static_cast<std::ptrdiff_t>((row + by) * (columns + 2 * by) + by));
  }
  depths_ = std::move(wider);
  column0 -= static_cast<std::int32_t>(by);
  row0 -= static_cast<std::int32_t>(by);
  columns += 2 * by;
  rows += 2 * by;
}

void ChartHits::go_to_offset(const Caster& caster, double offset) {
  // Even, as column0 and row0 are.
  const auto reach = 2 * static_cast<std::uint32_t>(std::ceil(std::abs(offset) / (2 * step_)));
  if (columns == 0) return;
  if (std::uint64_t{columns + 2 * reach} * (rows + 2 * reach) > max_hits) {
    columns = rows = 0;
    return;
  }
  widen(reach);
  least = infinity;
  most = -infinity;
  std::vector<OffsetHit> known(depths_.size());
  const auto follow = [&](std::size_t place, double from, const std::optional<Vector3>& near) {
    const std::size_t column = place % columns, row = place / columns;
    const Vector3 on_plane =
        support_plane_point(plane_, step_ * (column0 + static_cast<double>(column)),
                            step_ * (row0 + static_cast<double>(row)));
    return meet_offset(caster, offset, plane_, on_plane, from, near);
  };
  // By the tangent plane of a hit, so many columns and rows from there.
  const auto expected = [&](std::size_t from, int right, int down) {
    const Vector3& n = known[from].closest.direction;
    return known[from].depth +
           step_ * (right * n.dot(plane_.u) + down * n.dot(plane_.v)) / n.dot(plane_.n);
  };
  // Below the chart, where it is the chart that is nearest.
  std::vector<std::size_t> border;
  for (std::size_t i = 0; i < depths_.size(); ++i) {
    if (std::isnan(depths_[i])) continue;
    const bool beside_last = !border.empty() && border.back() + 1 == i;
    const std::optional<OffsetHit> hit =
        beside_last ? follow(i, expected(i - 1, 1, 0), known[i - 1].closest.closest_point)
                    : follow(i, static_cast<double>(depths_[i]), std::nullopt);
    depths_[i] = missing;
    if (!hit || !std::binary_search(chart_.triangles.begin(), chart_.triangles.end(),
                                    hit->closest.triangle)) {
      continue;
    }
    keep(i, hit->depth);
    known[i] = *hit;
    border.push_back(i);
  }
  for (std::uint32_t round = 0; round < reach; ++round) {
    std::vector<std::size_t> next;
    for (const std::size_t from : border) {
      const auto column = static_cast<std::int64_t>(from % columns);
      const auto row = static_cast<std::int64_t>(from / columns);
      constexpr std::array<std::array<int, 2>, 4> sides{{{-1, 0}, {1, 0}, {0, -1}, {0, 1}}};
      for (const auto& [right, down] : sides) {
        if (!has(column + right, row + down)) continue;
        const std::size_t beside = place(column + right, row + down);
        if (!std::isnan(depths_[beside])) continue;
        const std::optional<OffsetHit> hit =
            follow(beside, expected(from, right, down), known[from].closest.closest_point);
        if (!hit || (hit->closest.closest_point - known[from].closest.closest_point).norm() >
                        smooth_steps * step_) {
          continue;
        }
        keep(beside, hit->depth);
        known[beside] = *hit;
        next.push_back(beside);
      }
    }
    border = std::move(next);
  }
}

void ChartHits::add(const std::array<Vector3, 3>& corners) {
  constexpr double slack = 1e-9;
  std::array<std::array<double, 3>, 3> at{};  // column, row, depth
  for (std::size_t k = 0; k < 3; ++k) {
    const PlaneCoordinates place = project_on_plane(plane_, corners[k]);
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
      float& known = depths_[place(column, row)];
      if (std::isnan(known)) {
        known = static_cast<float>(depth);
      } else if (!(std::abs(static_cast<double>(known) - depth) < same_hit * step_)) {
        known = std::numeric_limits<float>::infinity();
      }
    }
  }
}

}  // namespace spm::baker
