// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <cstdint>
#include <span>

#include "common/asset/primitive_packets.hpp"

namespace spm {

/// A cube, and two upper bounds of the distance to the surface, each convex over the cube.
struct SurfaceCube {
  std::array<float, 3> middle{};  ///< m from the tree's origin
  float half = 0;                 ///< of its edge, m
  /// At the corners, m: bit 0 of a corner's number the upper side in x, 1: y, 2: z.
  std::array<std::array<float, 8>, 2> known{};
};

/// Bound of a packet's distance over the points of a cube.
struct PacketBounds {
  float lower_bound = 0;    ///< m: see packet_bounds; the least of its primitives
  std::uint32_t lanes = 0;  ///< a bit for each primitive that is in reach
};

/// Finds for packets by how much their primitives are at least farther than the surface, at any
/// point of a cube, m; those are in reach where it is no more than `slack`.
void packet_bounds(const PrimitivePackets& packets, std::span<const std::uint32_t> numbers,
                   const SurfaceCube& cube, float slack, PacketBounds* bounds) noexcept;

}  // namespace spm
