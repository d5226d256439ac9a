// SPDX-License-Identifier: GPL-3.0-or-later
#include "baker/tiles/tile_fit.hpp"

#include <Eigen/Cholesky>
#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>
#include <vector>

#include "baker/tiles/clip_fit.hpp"
#include "baker/tiles/tile_rays.hpp"
#include "formats/asset/tile_words.hpp"

namespace spm::baker {

namespace {

/// Weight of second differences against samples: enough to continue the surface past its border,
/// too little to bend it where there are samples.
constexpr double smoothness = 1e-3;
/// Weight of the slopes of a cell against heights.
constexpr double slope_weight = 0.1;
/// On facets: the weight of a slope that is met, the error at which a slope counts half, and how
/// often the weights are set again.
constexpr double facet_weight = 5;
constexpr double facet_slope = 0.005;
constexpr int facet_rounds = 2;

using Nodes = Eigen::Matrix<double, tile_sample_count, 1>;
using NodeMatrix = Eigen::Matrix<double, tile_sample_count, tile_sample_count>;

struct Weights {
  std::array<int, 4> node;
  std::array<double, 4> weight;
};

Weights weights_at(double x, double y) {
  const int column = std::clamp(static_cast<int>(x), 0, static_cast<int>(tile_cells) - 1);
  const int row = std::clamp(static_cast<int>(y), 0, static_cast<int>(tile_cells) - 1);
  const double fx = x - column, fy = y - row;
  const int first = row * static_cast<int>(tile_samples) + column;
  const int below = first + static_cast<int>(tile_samples);
  return {{first, first + 1, below, below + 1},
          {(1 - fx) * (1 - fy), fx * (1 - fy), (1 - fx) * fy, fx * fy}};
}

void add_second_differences(NodeMatrix& normal_matrix) {
  const auto add = [&](int a, int b, int c) {
    const std::array<int, 3> node{a, b, c};
    constexpr std::array<double, 3> weight{1, -2, 1};
    for (std::size_t i = 0; i < 3; ++i) {
      for (std::size_t j = 0; j < 3; ++j) {
        normal_matrix(node[i], node[j]) += smoothness * weight[i] * weight[j];
      }
    }
  };
  constexpr int side = tile_samples;
  for (int row = 0; row < side; ++row) {
    for (int column = 0; column < side; ++column) {
      const int middle = row * side + column;
      if (column > 0 && column + 1 < side) add(middle - 1, middle, middle + 1);
      if (row > 0 && row + 1 < side) add(middle - side, middle, middle + side);
    }
  }
  // The mixed difference keeps single corners from swinging.
  for (int row = 0; row + 1 < side; ++row) {
    for (int column = 0; column + 1 < side; ++column) {
      const int first = row * side + column;
      const std::array<int, 4> node{first, first + 1, first + side, first + side + 1};
      constexpr std::array<double, 4> weight{1, -1, -1, 1};
      for (std::size_t i = 0; i < 4; ++i) {
        for (std::size_t j = 0; j < 4; ++j) {
          normal_matrix(node[i], node[j]) += 2 * smoothness * weight[i] * weight[j];
        }
      }
    }
  }
}

/// Adds equations for the slopes of the triangles that the rays met, on each side of a cell's
/// border: what the hand feels of a facet is its direction. With known heights, a slope has less
/// weight where those heights are far off it. So most slopes are met and few are not (least
/// absolute deviations, by iterated weights).
void add_slopes(const TileRays& rays, const TileSite& site, const Nodes* known,
                NodeMatrix& normal_matrix, Nodes& right) {
  for (std::uint32_t k = 0; k < tile_cell_count * TileRays::in_cell; ++k) {
    const std::uint32_t cell = k / TileRays::in_cell, place = k % TileRays::in_cell;
    const int i = static_cast<int>(place) % (TileRays::per_cell + 1);
    const int j = static_cast<int>(place) / (TileRays::per_cell + 1);
    const TileRay& ray = rays.ray(TileRays::index(cell, i, j));
    if (!ray.hit) continue;
    const double scale = site.spacing / ray.normal->dot(site.plane.n);
    const double rise_x = scale * ray.normal->dot(site.plane.u);
    const double rise_y = scale * ray.normal->dot(site.plane.v);
    const double fx = static_cast<double>(i) / TileRays::per_cell;
    const double fy = static_cast<double>(j) / TileRays::per_cell;
    const Weights at = weights_at(cell % tile_cells, cell / tile_cells);
    const std::array<double, 4> along_x{fy - 1, 1 - fy, -fy, fy};
    const std::array<double, 4> along_y{fx - 1, -fx, 1 - fx, fx};
    double weight = slope_weight;
    if (known != nullptr) {
      double off_x = -rise_x, off_y = -rise_y;
      for (std::size_t a = 0; a < 4; ++a) {
        off_x += along_x[a] * (*known)[at.node[a]];
        off_y += along_y[a] * (*known)[at.node[a]];
      }
      weight = facet_weight / (1 + std::hypot(off_x, off_y) / (site.spacing * facet_slope));
    }
    for (std::size_t a = 0; a < 4; ++a) {
      right[at.node[a]] += weight * (along_x[a] * rise_x + along_y[a] * rise_y);
      for (std::size_t b = 0; b < 4; ++b) {
        normal_matrix(at.node[a], at.node[b]) +=
            weight * (along_x[a] * along_x[b] + along_y[a] * along_y[b]);
      }
    }
  }
}

/// Heights at the samples by least squares: depth below the plane, m. With `known` heights their
/// slopes give the weights.
Nodes fit_once(const TileRays& rays, const TileSite& site, const Nodes* known) {
  NodeMatrix normal_matrix = NodeMatrix::Zero();
  Nodes right = Nodes::Zero();
  for (std::uint32_t k = 0; k < TileRays::count; ++k) {
    const TileRay& ray = rays.ray(k);
    if (!ray.hit) continue;
    const Weights at = weights_at(TileRays::x_of(k), TileRays::y_of(k));
    for (std::size_t i = 0; i < 4; ++i) {
      right[at.node[i]] += at.weight[i] * ray.depth;
      for (std::size_t j = 0; j < 4; ++j) {
        normal_matrix(at.node[i], at.node[j]) += at.weight[i] * at.weight[j];
      }
    }
  }
  add_slopes(rays, site, known, normal_matrix, right);
  add_second_differences(normal_matrix);
  normal_matrix.diagonal().array() += 1e-9;
  // Relative to the seed's depth, so that the small weight on the diagonal draws towards the
  // surface.
  const double middle = rays.seed_depth();
  right -= middle * (normal_matrix * Nodes::Ones() - 1e-9 * Nodes::Ones());
  right = right.eval();
  return (normal_matrix.llt().solve(right).array() + middle).matrix();
}

Nodes fit_heights(const TileRays& rays, const TileSite& site) {
  Nodes nodes = fit_once(rays, site, nullptr);
  for (int round = 0; site.faceted && round < facet_rounds; ++round) {
    const Nodes known = nodes;
    nodes = fit_once(rays, site, &known);
  }
  return nodes;
}

/// Stores heights as the file does: base and slopes of their mean plane, and HALF residuals.
void store_heights(const Nodes& nodes, const TileSite& site, TileData& data) {
  constexpr int side = tile_samples;
  double slope_x = 0, slope_y = 0, mean = 0, squares = 0;
  for (int row = 0; row < side; ++row) {
    for (int column = 0; column < side; ++column) {
      const double x = column - 4.0, y = row - 4.0, z = nodes[row * side + column];
      mean += z / tile_sample_count;
      slope_x += x * z;
      slope_y += y * z;
      squares += x * x;
    }
  }
  const auto rounded = [&](double slope) {
    return half_to_float(float_to_half(static_cast<float>(slope / squares / site.spacing)));
  };
  data.slope_eta = rounded(slope_x);
  data.slope_omega = rounded(slope_y);
  const double step_x = static_cast<double>(data.slope_eta) * site.spacing;
  const double step_y = static_cast<double>(data.slope_omega) * site.spacing;
  data.base = static_cast<float>(mean - 4 * step_x - 4 * step_y);
  for (int row = 0; row < side; ++row) {
    for (int column = 0; column < side; ++column) {
      const double plane = static_cast<double>(data.base) + column * step_x + row * step_y;
      const auto k = static_cast<std::size_t>(row * side + column);
      data.heights[k] = float_to_half(
          static_cast<float>((nodes[static_cast<Eigen::Index>(k)] - plane) / site.height_unit));
    }
  }
}

/// How well a cell's patch agrees with its rays.
enum class Verdict { good, mixed, bad };

struct CellJudge {
  const TileRays& rays;
  const TileSite& site;
  const TileHeights& heights;
  double base;

  [[nodiscard]] bool on_layer(double depth, const Vector3& normal, double x, double y) const {
    return std::abs(depth - height(x, y)) * normal.dot(site.plane.n) <= site.residual;
  }
  [[nodiscard]] double height(double x, double y) const {
    const Weights at = weights_at(x, y);
    double sum = base;
    for (std::size_t i = 0; i < 4; ++i) {
      sum += at.weight[i] * static_cast<double>(heights[static_cast<std::size_t>(at.node[i])]);
    }
    return sum;
  }
  /// Unit normal of the patch at a place of a cell, in the object's frame.
  [[nodiscard]] Vector3 normal(std::uint32_t cell, double x, double y) const {
    const std::size_t first = cell / tile_cells * tile_samples + cell % tile_cells;
    const double fx = x - cell % tile_cells, fy = y - cell / tile_cells;
    const double h00 = static_cast<double>(heights[first]);
    const double h10 = static_cast<double>(heights[first + 1]);
    const double h01 = static_cast<double>(heights[first + tile_samples]);
    const double h11 = static_cast<double>(heights[first + tile_samples + 1]);
    const double slope_x = ((1 - fy) * (h10 - h00) + fy * (h11 - h01)) / site.spacing;
    const double slope_y = ((1 - fx) * (h01 - h00) + fx * (h11 - h10)) / site.spacing;
    return (site.plane.n + slope_x * site.plane.u + slope_y * site.plane.v).normalized();
  }

  double angle_sum = 0;
  int angle_count = 0;

  [[nodiscard]] Verdict judge(std::uint32_t cell) {
    int on = 0, off = 0;
    double angles = 0;
    for (int j = 0; j <= TileRays::per_cell; ++j) {
      for (int i = 0; i <= TileRays::per_cell; ++i) {
        const std::uint32_t k = TileRays::index(cell, i, j);
        const TileRay& ray = rays.ray(k);
        const double x = TileRays::x_of(k), y = TileRays::y_of(k);
        if (!ray.hit || !on_layer(ray.depth, *ray.normal, x, y)) {
          ++off;
          continue;
        }
        ++on;
        angles += std::acos(std::min(1.0, ray.normal->dot(normal(cell, x, y))));
      }
    }
    if (on == 0 || angles > site.cell_angle * on) return Verdict::bad;
    angle_sum += angles;
    angle_count += on;
    return off == 0 ? Verdict::good : Verdict::mixed;
  }
};

}  // namespace

Tile view_of(const TileData& data, double tile_spacing, double height_unit) {
  Tile tile = tile_over(data, tile_spacing);
  derive_bounds(tile, static_cast<float>(height_unit));
  return tile;
}

std::optional<TileFit> fit_tile(const Caster& caster, const TileSite& site, const TileSeed& seed) {
  TileRays rays(caster, site, seed);
  if (rays.hits() < 4) return std::nullopt;
  TileFit fit;
  TileData& data = fit.data;
  data.plane = site.which;
  data.level = site.level;
  data.column = site.column;
  data.row = site.row;
  store_heights(fit_heights(rays, site), site, data);
  Tile tile;
  tile.heights = data.heights.data();
  tile.spacing = static_cast<float>(site.spacing);
  tile.slope_eta = data.slope_eta;
  tile.slope_omega = data.slope_omega;
  TileHeights heights;
  tile_heights(tile, static_cast<float>(site.height_unit), heights);
  CellJudge judge{rays, site, heights, static_cast<double>(data.base)};
  std::array<Verdict, tile_cell_count> verdicts{};
  for (std::uint32_t cell = 0; cell < tile_cell_count; ++cell) verdicts[cell] = judge.judge(cell);
  if (judge.angle_count == 0 || judge.angle_sum > site.angle * judge.angle_count) return fit;
  for (std::uint32_t cell = 0; cell < tile_cell_count; ++cell) {
    if (verdicts[cell] == Verdict::bad) continue;
    const std::uint64_t bit = std::uint64_t{1} << cell;
    if (verdicts[cell] == Verdict::good) {
      data.valid |= bit;
      continue;
    }
    const auto on_layer = [&](double x, double y) {
      const std::optional<TileRay> ray = rays.cast(x, y, judge.height(x, y), 2 * site.residual);
      return ray && judge.on_layer(ray->depth, *ray->normal, x, y);
    };
    const std::optional<Clip> clip =
        fit_clip(cell % tile_cells + 0.5, cell / tile_cells + 0.5, on_layer);
    if (!clip) continue;
    data.valid |= bit;
    data.clipped |= bit;
    data.clips.push_back(pack_clip(*clip));
  }
  fit.good = data.valid != 0;
  return fit;
}

}  // namespace spm::baker
