// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "common/asset/asset_view.hpp"

namespace spm {

/// Largest number of tree nodes that box_clearance opens.
inline constexpr int max_clearance_nodes = 24;

/// Lower bound of the distance from a point (the asset's frame, m) to the surface of a `sparse`
/// asset, from the boxes of its elements alone. It is cheap, and known far beyond the margin, where
/// query_point answers `far`. 0 within a box, infinite without elements, never NaN.
[[nodiscard]] double box_clearance(const AssetView& asset, const Vector3& point) noexcept;

/// The same from the elements themselves: at least 0.8 of the distance, minus a tolerance. Takes as
/// long as a query.
[[nodiscard]] double surface_clearance(const AssetView& asset, const Vector3& point) noexcept;

}  // namespace spm
