// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>

#include "common/asset/cell_packet.hpp"
#include "common/base/vector.hpp"

namespace spm {

/// Distance given to an empty lane, m.
inline constexpr float empty_lane = 1e15F;

/// One vector for each primitive of a packet, axis by axis.
using PacketVectors = std::array<PacketLanes, 3>;

/// A barycentric coordinate that no point of a triangle has.
inline constexpr float no_share = 2;

/// A packet of eight triangles: a corner, m from the tree's origin, the two sides from it, and
/// values derived from them so that no query divides. A lane without a triangle is too far away for
/// any query.
struct alignas(32) TrianglePacket {
  TrianglePacket() noexcept {
    corner[0].fill(empty_lane);
    min_share.fill(no_share);
  }

  PacketVectors corner{}, side{}, other{};
  /// Of unit length; 0 where a triangle is too thin to have a normal.
  PacketVectors normal{};
  /// The dot products of these with a point's offset from the corner are the barycentric
  /// coordinates, along each side, of its projection on the plane, 1/m.
  PacketVectors along_side{}, along_other{};
  /// Lower limit of these two coordinates, and of 1 minus both, within a triangle: 0, or above all
  /// values where the triangle has no normal.
  PacketLanes min_share{};
  /// 1 over the squares of the sides and of the third one, 1/m^2; 0 where one has no length.
  PacketLanes per_side{}, per_other{}, per_third{};
  /// The first stored corner, and the second, which the third follows.
  std::array<std::uint32_t, packet_width> first{}, second{};
};

/// Puts a triangle into a lane; corners from the tree's origin, m.
void put_triangle(TrianglePacket& packet, std::size_t lane,
                  const std::array<Vector3, 3>& corners) noexcept;

}  // namespace spm
