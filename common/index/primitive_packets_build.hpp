// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <vector>

#include "common/asset/asset_view.hpp"

namespace spm {

/// All packets of an asset's primitives, and what the index's builder needs to know of the
/// primitives.
struct PrimitivePacketsData {
  std::vector<CellPacket> cells;
  std::vector<ClipPacket> clips;
  std::vector<TrianglePacket> triangles;
  /// Outward, unit, of each primitive, `packet_width` a packet; 0 where there is none or it tells
  /// no side.
  std::vector<Vector3> normals;
  std::uint32_t first_cap = 0;  ///< packets from this number on are of caps alone, others have none
  double median_width = 0;  ///< of two cells, or a triangle where there are no tiles: the median, m

  [[nodiscard]] PrimitivePackets view() const noexcept { return {cells, clips, triangles}; }
  [[nodiscard]] std::size_t size() const noexcept { return cells.size() + triangles.size(); }
};

/// Gathers the primitives of a `sparse` asset into packets of such as lie near each other.
/// Allocates.
[[nodiscard]] PrimitivePacketsData gather_primitive_packets(const AssetView& asset);

}  // namespace spm
