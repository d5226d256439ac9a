// SPDX-License-Identifier: GPL-3.0-or-later
#include "baker/full/map_filter.hpp"

#include <tbb/parallel_for.h>

#include <Eigen/Dense>
#include <algorithm>
#include <cmath>
#include <cstdint>
#include <limits>
#include <utility>

#include "common/paper/smoothing.hpp"

namespace spm::baker {

namespace {

/// Steeper steps between samples lead from one sheet to another.
constexpr double steepest = 2.5;
/// A window has at most so many samples on each side.
constexpr double widest = 256;

/// A layer of a map, and the slopes of D_SP at its samples.
class Layer {
 public:
  Layer(const MapData& map, std::uint32_t number)
      : map_(map), first_(std::size_t{number} * map.rows * map.columns) {
    slopes_.reserve(std::size_t{map.rows} * map.columns);
    for (std::int64_t row = 0; row < map.rows; ++row) {
      for (std::int64_t column = 0; column < map.columns; ++column) {
        slopes_.push_back({slope(column, row, 1, 0), slope(column, row, 0, 1)});
      }
    }
  }

  /// m; not finite where there is no hit.
  [[nodiscard]] double depth(std::int64_t column, std::int64_t row) const {
    if (column < 0 || row < 0 || column >= map_.columns || row >= map_.rows) return no_hit;
    return static_cast<double>(map_.samples[first_ + index(column, row)]);
  }

  /// The filtered sample, m. Samples to which a step from it would be too steep are of another
  /// sheet and do not count.
  [[nodiscard]] double filtered(std::int64_t column, std::int64_t row, double sigma,
                                double least_cosine) const {
    const auto reach = static_cast<std::int64_t>(
        std::min(widest, std::floor(gaussian_cutoff * sigma / map_.spacing)));
    const double own = depth(column, row);
    const Slope& here = slopes_[index(column, row)];
    Eigen::Matrix3d sums = Eigen::Matrix3d::Zero();
    Vector3 right = Vector3::Zero();
    for (std::int64_t j = -reach; j <= reach; ++j) {
      for (std::int64_t i = -reach; i <= reach; ++i) {
        const double other = depth(column + i, row + j);
        const double way =
            map_.spacing * std::hypot(static_cast<double>(i), static_cast<double>(j));
        if (!std::isfinite(other) || std::abs(other - own) > steepest * way) continue;
        if (cosine(here, slopes_[index(column + i, row + j)]) < least_cosine) continue;
        const double eta = map_.spacing * static_cast<double>(i);
        const double omega = map_.spacing * static_cast<double>(j);
        const double weight = gaussian_kernel(sigma, eta, omega) * map_.spacing * map_.spacing;
        const Vector3 terms(1, eta / sigma, omega / sigma);
        sums += weight * terms * terms.transpose();
        right += weight * (other - own) * terms;
      }
    }
    if (!(sums(0, 0) > 0)) return own;
    // The mean over a whole window; where it is cut off, what the plane of its samples has there.
    constexpr double ridge = 1e-9;
    sums(1, 1) += ridge * sums(0, 0);
    sums(2, 2) += ridge * sums(0, 0);
    return own + sums.ldlt().solve(right)[0];
  }

 private:
  struct Slope {
    double eta = 0, omega = 0;
  };
  const MapData& map_;
  std::size_t first_;
  std::vector<Slope> slopes_;

  [[nodiscard]] std::size_t index(std::int64_t column, std::int64_t row) const {
    return static_cast<std::size_t>(row) * map_.columns + static_cast<std::size_t>(column);
  }

  /// Of n_S at two samples (eq. 5).
  static double cosine(const Slope& a, const Slope& b) {
    return (1 + a.eta * b.eta + a.omega * b.omega) /
           std::sqrt((1 + a.eta * a.eta + a.omega * a.omega) *
                     (1 + b.eta * b.eta + b.omega * b.omega));
  }

  /// The derivative of D_SP along one axis: on the side on which it bends less, so that beside an
  /// edge it is that of the own side; in the middle of both where they agree.
  [[nodiscard]] double slope(std::int64_t column, std::int64_t row, std::int64_t i,
                             std::int64_t j) const {
    const auto at = [&](std::int64_t k) { return depth(column + k * i, row + k * j); };
    const double own = at(0);
    const auto usable = [&](double step) {
      return std::isfinite(step) && std::abs(step) <= steepest * map_.spacing;
    };
    const double before = own - at(-1), after = at(1) - own;
    if (!usable(before) && !usable(after)) return 0;
    if (!usable(before)) return after / map_.spacing;
    if (!usable(after)) return before / map_.spacing;
    const auto bend = [&](double far_step, double step) {
      return usable(far_step) ? std::abs(far_step - step) : std::numeric_limits<double>::infinity();
    };
    const double bend_before = bend(at(-1) - at(-2), before);
    const double bend_after = bend(at(2) - at(1), after);
    const double bend_here = std::abs(after - before);
    if (bend_here <= std::min(bend_before, bend_after)) return (before + after) / 2 / map_.spacing;
    return (bend_before <= bend_after ? before : after) / map_.spacing;
  }
};

}  // namespace

void filter_maps(std::vector<MapData>& maps, const SmoothOptions& options) {
  if (options.kind == Smoothing::none) return;
  const double least_cosine = options.kind == Smoothing::crease ? std::cos(options.angle) : -1;
  tbb::parallel_for(std::size_t{0}, maps.size(), [&](std::size_t k) {
    MapData& map = maps[k];
    std::vector<float> filtered = map.samples;
    for (std::uint32_t layer = 0; layer < map.layers; ++layer) {
      const Layer known(map, layer);
      std::size_t at = std::size_t{layer} * map.rows * map.columns;
      for (std::int64_t row = 0; row < map.rows; ++row) {
        for (std::int64_t column = 0; column < map.columns; ++column, ++at) {
          if (!std::isfinite(filtered[at])) continue;
          filtered[at] =
              static_cast<float>(known.filtered(column, row, options.sigma, least_cosine));
        }
      }
    }
    map.samples = std::move(filtered);
  });
}

}  // namespace spm::baker
