// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <vector>

#include "common/asset/asset_view.hpp"

namespace spm {

/// The memory that an ElementIndex points into.
struct ElementIndexData {
  Vector3 origin = Vector3::Zero();
  double cell_size = 1;
  std::array<std::uint32_t, 3> cells{0, 0, 0};
  std::vector<std::uint32_t> words;
  double slack = 0;
  std::vector<CellPacket> cell_packets;
  std::vector<ClipPacket> clip_packets;
  std::vector<TrianglePacket> triangle_packets;

  [[nodiscard]] ElementIndex view() const noexcept {
    return {origin,
            cell_size,
            1 / cell_size,
            cells,
            words,
            slack,
            {cell_packets, clip_packets, triangle_packets}};
  }
  [[nodiscard]] std::size_t bytes() const noexcept {
    return 4 * words.size() + sizeof(CellPacket) * cell_packets.size() +
           sizeof(ClipPacket) * clip_packets.size() +
           sizeof(TrianglePacket) * triangle_packets.size();
  }
};

/// Builds the index of a `sparse` asset from its trees. Wherever the surface is within the band,
/// the list of a cube names every element that can matter to a point of the cube. Allocates: for
/// the loading thread. Empty for an asset that is not `sparse`.
[[nodiscard]] ElementIndexData build_element_index(const AssetView& asset);

}  // namespace spm
