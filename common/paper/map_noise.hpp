// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <cstdint>

#include "common/asset/asset_view.hpp"

namespace spm {

/// n_g of eq. 19 over its standard deviation: Gaussian noise that is a part of the distance map. Of
/// mean 0 and deviation 1 at each sample of layer 0 of plane `plane`'s map in a `full` asset, and
/// bilinear between samples, as D_SP is. The seed, the plane and the sample alone decide it, so the
/// same place of the surface always feels the same. At P_M of a point (asset's frame, m); 0 outside
/// the map.
[[nodiscard]] double map_noise(const AssetView& asset, std::size_t plane, const Vector3& point,
                               std::uint64_t seed) noexcept;

}  // namespace spm
