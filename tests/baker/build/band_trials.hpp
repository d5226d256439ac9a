// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <cstdint>
#include <vector>

#include "baker/cast/cast.hpp"
#include "common/asset/asset_view.hpp"

namespace spm::baker {

/// Places at which a finished asset is tried, fixed by a seed. They lie over the band by the
/// surface's area, close to the surface, close to edges, and farther about corners, where sides are
/// hardest to tell.
class BandTrials {
 public:
  /// Lengths in metres. Keeps a reference.
  BandTrials(const Caster& caster, const Band& band, double tolerance, std::uint64_t seed);

  [[nodiscard]] Vector3 point(std::uint64_t index) const;

 private:
  const Caster& caster_;
  Band band_;
  double tolerance_;
  std::uint64_t seed_;
  std::vector<double> areas_;  ///< running sums
  std::vector<double> edges_;  ///< running sums of the weights of edges, three a triangle

  [[nodiscard]] Vector3 near_edge(std::uint64_t index) const;
  [[nodiscard]] Vector3 near_corner(std::uint64_t index) const;
  /// An offset from an edge or corner, in any direction, up to the band's depth.
  [[nodiscard]] Vector3 offset(std::uint64_t index) const;
};

}  // namespace spm::baker
