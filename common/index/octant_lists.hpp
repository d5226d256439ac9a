// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <cstddef>

#include "common/asset/asset_view.hpp"
#include "common/index/index_lists.hpp"
#include "common/index/primitive_packets_build.hpp"

namespace spm {

/// Places that octant_lists looks from.
inline constexpr std::size_t octant_corners = 27;

/// Of some packets (at most index_list_packets) those that can matter to a point of each octant of
/// a cube (`half` of its edge, m): as its nearest, or no farther than by a slack (m). `rounding`:
/// how far distances may be off, m. Where one place is nearer than another is a half-space: so what
/// is nowhere nearer than a place of the surface at the corners of a cube is nowhere nearer in it.
[[nodiscard]] std::array<IndexLists, 8> octant_lists(const AssetView& asset,
                                                     const PrimitivePacketsData& primitives,
                                                     const Vector3& middle, double half,
                                                     const PacketNumbers& some, double slack,
                                                     double rounding);

}  // namespace spm
