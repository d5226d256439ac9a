// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <array>
#include <cstdint>
#include <optional>

#include "baker/tiles/tile_fit.hpp"

namespace spm::baker {

/// Where a ray of a tile met the surface.
struct TileRay {
  bool hit = false;
  double depth = 0;                 ///< below the plane, m
  const Vector3* normal = nullptr;  ///< of the triangle
};

/// Rays of a tile on a lattice finer than its samples. They are followed from the seed to neighbour
/// after neighbour, as long as the surface continues without a crease. Places are in units of cells
/// of the tile.
class TileRays {
 public:
  static constexpr int per_cell = 2;  ///< lattice steps along a cell
  static constexpr std::uint32_t in_cell = (per_cell + 1) * (per_cell + 1);  ///< borders included
  static constexpr std::uint32_t side = per_cell * tile_cells + 1;
  static constexpr std::uint32_t count = side * side;

  TileRays(const Caster& caster, const TileSite& site, const TileSeed& seed);

  [[nodiscard]] const TileRay& ray(std::uint32_t k) const { return rays_[k]; }
  [[nodiscard]] std::uint32_t hits() const { return hits_; }
  [[nodiscard]] double seed_depth() const { return seed_depth_; }

  /// The entry within `window` of a depth at a place. Empty where there is none.
  [[nodiscard]] std::optional<TileRay> cast(double x, double y, double depth, double window) const;

  [[nodiscard]] static double x_of(std::uint32_t k) {
    return static_cast<double>(k % side) / per_cell;
  }
  [[nodiscard]] static double y_of(std::uint32_t k) {
    return static_cast<double>(k / side) / per_cell;
  }
  /// Ray (i, j), from 0 to per_cell, of a cell.
  [[nodiscard]] static std::uint32_t index(std::uint32_t cell, int i, int j) {
    return (cell / tile_cells * per_cell + static_cast<std::uint32_t>(j)) * side +
           cell % tile_cells * per_cell + static_cast<std::uint32_t>(i);
  }

 private:
  const Caster& caster_;
  const TileSite& site_;
  double eta0_, omega0_;
  double seed_depth_ = 0;
  std::uint32_t hits_ = 0;
  std::array<TileRay, count> rays_{};

  void follow(std::uint32_t start);
  void visit(std::uint32_t k, const TileRay& from, double dx, double dy,
             std::vector<std::uint32_t>& open);
};

}  // namespace spm::baker
