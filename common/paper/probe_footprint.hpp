// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>

#include "common/asset/asset_view.hpp"
#include "common/paper/implicit_probe.hpp"

namespace spm {

/// Samples that a probe's force is a mean of, so that a tick's time has a bound: about this many
/// under a probe (the area of its projection, or that of the map if this is less), in no case more
/// than three times as many and 2.
inline constexpr std::uint32_t most_probe_samples = 1024;
/// At least about this many side by side across its width, as far as the bound above allows: some
/// 254 under a ball. A probe that covers fewer of a map's samples is measured between them.
inline constexpr std::uint32_t least_probe_samples_across = 18;

/// Places on a lattice along one row of it, from `first` to `last`; none if `first` is above
/// `last`.
struct LatticeRange {
  std::int64_t first = 0, last = -1;
};

/// C_S of eq. 10: the places of a support plane that lie under a probe, on a lattice. This is the
/// lattice of the map's samples, or one that is coarser for a large probe, and finer for a small
/// one; the map is interpolated there. It depends on the map and on the probe's form and direction,
/// not on where the probe is, so that it does not move with the hand.
class ProbeFootprint {
 public:
  ProbeFootprint(const DistanceMap& map, const SupportPlane& plane,
                 const ImplicitProbe& probe) noexcept;

  /// Rows that may have places.
  [[nodiscard]] LatticeRange rows() const noexcept;
  /// Places in a row: all that can lie under the probe, and a margin of rounding.
  [[nodiscard]] LatticeRange columns(std::int64_t row) const noexcept;
  /// The cell of the map, and the position in it, of a place.
  [[nodiscard]] MapCell cell(std::int64_t column, std::int64_t row) const noexcept;
  /// Distance of places in samples.
  [[nodiscard]] double step() const noexcept { return step_; }

 private:
  double x_ = 0, y_ = 0;              ///< middle of the probe, in samples
  double along_x_ = 0, along_y_ = 0;  ///< its half axis, in samples
  double radius_ = 0;                 ///< in samples
  double step_ = 1;
  std::uint32_t columns_, rows_;  ///< of the map

  [[nodiscard]] LatticeRange between(double from, double to, std::uint32_t samples) const noexcept;
};

}  // namespace spm
