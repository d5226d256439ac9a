// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <cstdint>
#include <vector>

#include "baker/cast/cast.hpp"
#include "baker/cast/surface_points.hpp"
#include "common/asset/asset_view.hpp"

namespace spm::baker {

/// Points at which a partition is tried. The first kind is where a user's hand may be: uniform over
/// the surface by area, at depths uniform over the band. The second kind is above and below the
/// borders of the maps' valid cells, where gaps would be. Every second one of these is close to the
/// surface.
class Trials {
 public:
  /// `uniform`: the number of points of the first kind. `nearby`: how close to the surface every
  /// second point of the other kind is, m.
  Trials(const AssetView& asset, const Caster& caster, std::uint64_t uniform, double nearby,
         std::uint64_t seed);

  [[nodiscard]] std::uint64_t count() const;
  [[nodiscard]] Probe probe(std::uint64_t index) const;

 private:
  struct BorderCell {
    std::uint32_t map, layer, column, row;
  };
  void collect_borders();
  [[nodiscard]] Probe anywhere(std::uint64_t index) const;
  [[nodiscard]] Probe about_border(std::uint64_t index) const;

  const AssetView& asset_;
  const Caster& caster_;
  std::uint64_t uniform_;
  double nearby_;
  std::uint64_t seed_;
  std::vector<double> areas_;  ///< running sums, twice the triangles' areas
  std::vector<BorderCell> borders_;
};

}  // namespace spm::baker
