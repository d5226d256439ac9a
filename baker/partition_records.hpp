// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <array>
#include <cstdint>
#include <memory>
#include <vector>

#include "baker/fallback_triangles.hpp"
#include "baker/tile_partition.hpp"

namespace spm::baker {

/// An element of a list while the partition is made: a tile's number, or, with this bit, that of a
/// triangle among the FallbackTriangles.
inline constexpr std::uint32_t triangle_flag = 1U << 31U;

/// A cube of the partition as decided, before it is laid out: without octants, a leaf.
struct PartitionNode {
  CellKind kind = CellKind::far;
  bool exact = false;        ///< lists the surface's own triangles
  /// The side that the whole cube is on, told where it is on none; written only where it must be.
  ListSide side = ListSide::told;
  bool side_needed = false;  ///< its elements tell the side wrong somewhere
  unsigned rule = 0;         ///< by which it is pruned, 0 where it is not
  std::uint32_t normal = 0;  ///< of a deep cube, octahedral
  double edge = 0;
  Vector3 middle = Vector3::Zero();
  std::vector<std::uint32_t> elements;
  std::unique_ptr<std::array<PartitionNode, 8>> octants;
};

/// Lays the decided cubes out as the grid's words, equal lists once; numbers tiles and triangles in
/// the order of their first use and drops those without any.
[[nodiscard]] TilePartitionCounts write_records(Asset& asset, const FallbackTriangles& fallback,
                                                const std::vector<PartitionNode>& nodes);

}  // namespace spm::baker
