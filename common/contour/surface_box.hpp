// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "common/asset/asset_view.hpp"

namespace spm {

/// A box that the surface of an asset lies in: the mesh's own where it is known, since that of the
/// band may be far larger.
[[nodiscard]] inline Extent surface_box(const AssetView& asset) noexcept {
  const bool known = asset.box_low.allFinite() && asset.box_high.allFinite() &&
                     (asset.box_low.array() <= asset.box_high.array()).all();
  return known ? Extent{asset.box_low, asset.box_high - asset.box_low} : extent_of(asset);
}

}  // namespace spm
