// SPDX-License-Identifier: Apache-2.0
#include "common/asset/cell_packet.hpp"

#include <algorithm>
#include <cmath>

#include "common/surface/closest_on_cell.hpp"

namespace spm {

namespace {

/// How deep a cell lies that is not valid, spacings: its square is a float still.
constexpr float out_of_reach = 1e15F;

}  // namespace

CellPacket cell_packet(const Tile& tile, float height_unit, const SupportPlane& plane,
                       std::uint32_t part, const Vector3& origin) noexcept {
  TileHeights heights;
  tile_heights(tile, height_unit, heights);
  const float per_spacing = 1 / tile.spacing;
  CellPacket packet;
  packet.part = part;
  packet.spacing = tile.spacing;
  for (std::uint32_t lane = 0; lane < packet_width; ++lane) {
    const std::uint32_t cell = cell_of(packet, lane);
    if (((tile.valid >> cell) & 1U) == 0) {
      packet.depth[lane] = out_of_reach;
      continue;
    }
    const std::uint32_t first = cell / tile_cells * tile_samples + cell % tile_cells;
    const float h00 = heights[first] * per_spacing, h10 = heights[first + 1] * per_spacing,
                h01 = heights[first + tile_samples] * per_spacing,
                h11 = heights[first + tile_samples + 1] * per_spacing;
    packet.slope_eta[lane] = ((h10 - h00) + (h11 - h01)) * 0.5F;
    packet.slope_omega[lane] = ((h01 - h00) + (h11 - h10)) * 0.5F;
    const float eta = packet.slope_eta[lane], omega = packet.slope_omega[lane];
    packet.per_eta[lane] = 1 / (1 + eta * eta);
    packet.per_omega[lane] = 1 / (1 + omega * omega);
    packet.level_eta[lane] = eta / (1 + eta * eta + omega * omega);
    packet.twist[lane] = h00 - h10 - h01 + h11;
    packet.depth[lane] = (h00 + h10 + h01 + h11) * 0.25F;
  }
  const auto spacing = static_cast<double>(tile.spacing);
  const std::uint32_t first = cell_of(packet, 0);
  const std::uint32_t column = first % tile_cells, row = first / tile_cells;
  const Vector3 corner =
      support_plane_point(plane, tile.eta0 + column * spacing, tile.omega0 + row * spacing) -
      tile.base * plane.n - origin;
  for (int k = 0; k < 3; ++k) {
    const auto axis = static_cast<std::size_t>(k);
    packet.origin[axis] = static_cast<float>(corner[k]);
    packet.steps[axis] = {static_cast<float>(plane.u[k] / spacing),
                          static_cast<float>(plane.v[k] / spacing),
                          static_cast<float>(-plane.n[k] / spacing), 0};
  }
  // By the steps as they are rounded: so that their rounding counts from the origin on only.
  for (std::size_t along = 0; along < 3; ++along) {
    packet.base[along] = static_cast<float>(corner.x() * double{packet.steps[0][along]} +
                                            corner.y() * double{packet.steps[1][along]} +
                                            corner.z() * double{packet.steps[2][along]});
  }
  return packet;
}

ClipPacket clip_packet(const Tile& tile, const CellPacket& packet) noexcept {
  ClipPacket clips;
  for (std::uint32_t lane = 0; lane < packet_width; ++lane) {
    const std::uint32_t cell = cell_of(packet, lane);
    if (((tile.clipped >> cell) & 1U) == 0) continue;
    const Clip clip = cell_clip(tile, cell);
    ClipSegment segment{out_of_reach, 0, 0, 0};
    if (!clip_segment(clip, segment)) segment.x = out_of_reach;
    clips.a[lane] = clip.a;
    clips.b[lane] = clip.b;
    clips.c[lane] = clip.c;
    clips.x[lane] = segment.x;
    clips.y[lane] = segment.y;
    clips.to_x[lane] = segment.to_x;
    clips.to_y[lane] = segment.to_y;
  }
  return clips;
}

namespace {

/// A lane's patch, and a place from its middle.
CellPatch patch_at(const CellPacket& packet, std::uint32_t lane, const Vector3& place) noexcept {
  // From the packet's origin in floats: near it they are exact enough.
  const auto from = [&](int k) {
    return static_cast<float>(place[k] -
                              static_cast<double>(packet.origin[static_cast<std::size_t>(k)]));
  };
  const float x = from(0), y = from(1), z = from(2);
  const auto along = [&](std::size_t axis) {
    return packet.steps[0][axis] * x + packet.steps[1][axis] * y + packet.steps[2][axis] * z;
  };
  const std::uint32_t column = lane % packet_columns, row = lane / packet_columns;
  return {packet.slope_eta[lane],
          packet.slope_omega[lane],
          packet.twist[lane],
          along(0) - (static_cast<float>(column) + 0.5F),
          along(1) - (static_cast<float>(row) + 0.5F),
          along(2) - packet.depth[lane]};
}

TileClosestPoint closest_point_at(const CellPacket& packet, std::uint32_t lane,
                                  const CellPatch& patch, float x, float y) noexcept {
  TileClosestPoint closest_point;
  closest_point.cell = cell_of(packet, lane);
  closest_point.slope_eta = patch.slope_x + patch.twist * y;
  closest_point.slope_omega = patch.slope_y + patch.twist * x;
  closest_point.away_eta = (patch.dx - x) * packet.spacing;
  closest_point.away_omega = (patch.dy - y) * packet.spacing;
  closest_point.away_depth = (patch.dz - patch.height(x, y)) * packet.spacing;
  settle_closest_point(closest_point, std::sqrt(patch.squared_distance(x, y)) * packet.spacing);
  return closest_point;
}

}  // namespace

TileClosestPoint closest_point_on_cell(const CellPacket& packet, std::uint32_t lane,
                                       const Vector3& place, float x, float y) noexcept {
  const CellPatch patch = patch_at(packet, lane, place);
  const bool on_border = std::abs(x) == 0.5F || std::abs(y) == 0.5F;
  if (on_border && packet.clips == 0) closest_on_patch(patch, x, y);
  return closest_point_at(packet, lane, patch, x, y);
}

TileClosestPoint closest_on_cell(const Tile& tile, const CellPacket& packet, std::uint32_t lane,
                                 const Vector3& place, float limit) noexcept {
  const CellPatch patch = patch_at(packet, lane, place);
  float x = 0, y = 0;
  closest_on_patch(patch, x, y);
  TileClosestPoint closest_point;
  closest_point.cell = cell_of(packet, lane);
  if (((tile.clipped >> closest_point.cell) & 1U) != 0 &&
      !clip_closest_point(patch, cell_clip(tile, closest_point.cell), 1, x, y)) {
    return closest_point;
  }
  const float most = limit / packet.spacing;
  if (!(patch.squared_distance(x, y) < most * most)) return closest_point;
  return closest_point_at(packet, lane, patch, x, y);
}

}  // namespace spm
