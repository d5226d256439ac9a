// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>

#include "common/surface/closest_on_tile.hpp"
#include "common/surface/support_plane.hpp"
#include "common/surface/tile.hpp"

namespace spm {

/// Number of primitives in a packet; they are processed together by SIMD.
inline constexpr std::size_t packet_width = 8;

/// One number for each primitive of a packet.
using PacketLanes = std::array<float, packet_width>;

/// The clip lines of a packet's cells, from the cells' middles, with the spacing as the unit. A
/// cell is valid where a x + b y <= c; the line crosses the cell from (x, y) by (to_x, to_y).
/// Without a line (a, b) is 0. Where nothing of the cell is left, x is too far away for any query.
struct alignas(64) ClipPacket {
  PacketLanes a{}, b{}, c{}, x{}, y{}, to_x{}, to_y{};
};

/// A packet of eight cells of a tile, four along eta and two along omega: their bilinear patches
/// about their middles, with the spacing as the unit. Slopes of the mean plane along eta and omega,
/// twist h00 - h10 - h01 + h11, and depth of the middle below the tile's base. A cell that is not
/// valid is put too far away for any query. Derived from the heights, so that all eight cells are
/// processed together.
struct alignas(32) CellPacket {
  PacketLanes slope_eta{}, slope_omega{}, twist{}, depth{};
  /// Of the slopes: 1 / (1 + eta^2), 1 / (1 + omega^2), and eta / (1 + eta^2 + omega^2).
  PacketLanes per_eta{}, per_omega{}, level_eta{};
  /// What a step along x, y or z is along eta, omega and depth, spacings per m; the last is 0.
  std::array<std::array<float, 4>, 3> steps{};
  std::array<float, 4> base{};  ///< the origin along eta, omega and depth, spacings; the last is 0
  std::array<float, 3> origin{};  ///< first sample, at the tile's base, m from the tree's origin
  float spacing = 0;              ///< m
  std::uint32_t tile = 0;
  std::uint32_t part =
      0;  ///< of the tile's eighths: bit 0 the upper half along eta, 1-2 which rows
  std::uint32_t clips = 0;  ///< number of its ClipPacket, from 1; 0 where none is clipped
};
inline constexpr std::uint32_t packet_columns = 4;
inline constexpr std::uint32_t packet_rows = 2;

/// The cell of the tile that is on this lane of a packet.
[[nodiscard]] constexpr std::uint32_t cell_of(const CellPacket& packet,
                                              std::uint32_t lane) noexcept {
  const std::uint32_t column = (packet.part & 1U) * packet_columns + lane % packet_columns;
  const std::uint32_t row = (packet.part >> 1U) * packet_rows + lane / packet_columns;
  return row * tile_cells + column;
}

/// Number of packets of a tile's cells; some may have no valid cell.
inline constexpr std::uint32_t tile_packets = tile_cell_count / packet_width;

/// Packet `part` of a tile's cells, relative to an origin (m).
[[nodiscard]] CellPacket cell_packet(const Tile& tile, float height_unit, const SupportPlane& plane,
                                     std::uint32_t part, const Vector3& origin) noexcept;

/// The clip lines of a packet of a tile's cells.
[[nodiscard]] ClipPacket clip_packet(const Tile& tile, const CellPacket& packet) noexcept;

/// The closest point on one lane of a packet as a TileClosestPoint, from x and y relative to the
/// cell's middle, spacings. `place` from the same origin, m.
[[nodiscard]] TileClosestPoint closest_point_on_cell(const CellPacket& packet, std::uint32_t lane,
                                                     const Vector3& place, float x,
                                                     float y) noexcept;

/// closest_on_tile for one lane of a packet of the tile's cells only; `place` from the same origin,
/// m. Infinite where the lane's cell is not valid.
[[nodiscard]] TileClosestPoint closest_on_cell(const Tile& tile, const CellPacket& packet,
                                               std::uint32_t lane, const Vector3& place,
                                               float limit) noexcept;

}  // namespace spm
