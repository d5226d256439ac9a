// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include "common/asset/asset_view.hpp"

namespace spm::baker {

/// From what places are answered: shares that sum to 1, or are 0.
struct AnswerShares {
  double one_map = 0, two_maps = 0, triangles = 0;
};

/// The shares of a `sparse` asset, by its own answers: of the band's volume, and of its surface.
struct SharesOfPlaces {
  AnswerShares band, surface;
};

/// Tries a lattice of places in each leaf. Beyond the band nothing counts, so a leaf of which half
/// lies there counts half.
[[nodiscard]] SharesOfPlaces shares_of_places(const AssetView& view);

}  // namespace spm::baker
