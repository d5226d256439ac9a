// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <cstdint>
#include <vector>

#include "baker/cast.hpp"
#include "baker/surface_points.hpp"
#include "common/asset_view.hpp"

namespace spm::baker {

/// Points at which a partition is tried: uniform over the surface by area, at depths uniform over
/// the band, as a user's hand may be anywhere.
class Trials {
 public:
  Trials(const Caster& caster, const Band& band, std::uint64_t count, std::uint64_t seed);

  [[nodiscard]] std::uint64_t count() const { return count_; }
  [[nodiscard]] Probe probe(std::uint64_t index) const;

 private:
  const Caster& caster_;
  Band band_;
  std::uint64_t count_;
  std::uint64_t seed_;
  std::vector<double> areas_;  ///< running sums, twice the triangles' areas
};

}  // namespace spm::baker
