// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <cstdint>
#include <vector>

#include "baker/cast/cast.hpp"
#include "baker/cast/surface_points.hpp"
#include "common/asset/asset_view.hpp"

namespace spm::baker {

/// Points at which a partition is tried: where a user's hand may be, uniform over the surface by
/// area and at depths uniform over the band; and above and below the borders of the maps' valid
/// cells, where gaps would be, every second one close to the surface.
class Trials {
 public:
  /// `uniform`: how many points of the first kind; `nearby`: how close to the surface every second
  /// one of the others keeps, m.
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
