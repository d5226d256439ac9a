// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <cstdint>
#include <utility>
#include <vector>

#include "common/asset/asset_view.hpp"

namespace spm::baker {

/// Places about the lines at which tiles are clipped, fixed by a seed. A tile ends there, and says
/// little about the side.
class BorderTrials {
 public:
  /// Keeps a reference to the asset, whose tiles must not change.
  BorderTrials(const AssetView& asset, std::uint64_t seed);

  [[nodiscard]] bool empty() const { return cells_.empty(); }
  /// A place. The set must not be empty.
  [[nodiscard]] Vector3 point(std::uint64_t index) const;

 private:
  const AssetView& asset_;
  std::uint64_t seed_;
  std::vector<std::pair<std::uint32_t, std::uint32_t>> cells_;  ///< tile and clipped cell
};

}  // namespace spm::baker
