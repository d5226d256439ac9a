// SPDX-License-Identifier: Apache-2.0
#include "common/asset/cell_group.hpp"

#include <algorithm>
#include <cmath>

#include "common/surface/cell_foot.hpp"

namespace spm {

namespace {

/// How deep a cell lies that is not valid, spacings: its square is a float still.
constexpr float out_of_reach = 1e15F;

}  // namespace

CellGroup cell_group(const Tile& tile, float height_unit, const SupportPlane& plane,
                     std::uint32_t part, const Vector3& origin) noexcept {
  TileHeights heights;
  tile_heights(tile, height_unit, heights);
  const float per_spacing = 1 / tile.spacing;
  CellGroup group;
  group.part = part;
  group.spacing = tile.spacing;
  for (std::uint32_t lane = 0; lane < group_units; ++lane) {
    const std::uint32_t cell = cell_of(group, lane);
    if (((tile.valid >> cell) & 1U) == 0) {
      group.depth[lane] = out_of_reach;
      continue;
    }
    const std::uint32_t first = cell / tile_cells * tile_samples + cell % tile_cells;
    const float h00 = heights[first] * per_spacing, h10 = heights[first + 1] * per_spacing,
                h01 = heights[first + tile_samples] * per_spacing,
                h11 = heights[first + tile_samples + 1] * per_spacing;
    group.slope_eta[lane] = ((h10 - h00) + (h11 - h01)) * 0.5F;
    group.slope_omega[lane] = ((h01 - h00) + (h11 - h10)) * 0.5F;
    const float eta = group.slope_eta[lane], omega = group.slope_omega[lane];
    group.per_eta[lane] = 1 / (1 + eta * eta);
    group.per_omega[lane] = 1 / (1 + omega * omega);
    group.level_eta[lane] = eta / (1 + eta * eta + omega * omega);
    group.twist[lane] = h00 - h10 - h01 + h11;
    group.depth[lane] = (h00 + h10 + h01 + h11) * 0.25F;
  }
  const auto spacing = static_cast<double>(tile.spacing);
  const std::uint32_t first = cell_of(group, 0);
  const std::uint32_t column = first % tile_cells, row = first / tile_cells;
  const Vector3 corner =
      support_plane_point(plane, tile.eta0 + column * spacing, tile.omega0 + row * spacing) -
      tile.base * plane.n - origin;
  for (int k = 0; k < 3; ++k) {
    const auto axis = static_cast<std::size_t>(k);
    group.origin[axis] = static_cast<float>(corner[k]);
    group.steps[axis] = {static_cast<float>(plane.u[k] / spacing),
                         static_cast<float>(plane.v[k] / spacing),
                         static_cast<float>(-plane.n[k] / spacing), 0};
  }
  // By the steps as they are rounded: so that their rounding counts from the origin on only.
  for (std::size_t along = 0; along < 3; ++along) {
    group.base[along] = static_cast<float>(corner.x() * double{group.steps[0][along]} +
                                           corner.y() * double{group.steps[1][along]} +
                                           corner.z() * double{group.steps[2][along]});
  }
  return group;
}

ClipGroup clip_group(const Tile& tile, const CellGroup& group) noexcept {
  ClipGroup clips;
  for (std::uint32_t lane = 0; lane < group_units; ++lane) {
    const std::uint32_t cell = cell_of(group, lane);
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
CellPatch patch_at(const CellGroup& group, std::uint32_t lane, const Vector3& place) noexcept {
  // From the group's origin in floats: near it they are exact enough.
  const auto from = [&](int k) {
    return static_cast<float>(place[k] -
                              static_cast<double>(group.origin[static_cast<std::size_t>(k)]));
  };
  const float x = from(0), y = from(1), z = from(2);
  const auto along = [&](std::size_t axis) {
    return group.steps[0][axis] * x + group.steps[1][axis] * y + group.steps[2][axis] * z;
  };
  const std::uint32_t column = lane % group_columns, row = lane / group_columns;
  return {group.slope_eta[lane],
          group.slope_omega[lane],
          group.twist[lane],
          along(0) - (static_cast<float>(column) + 0.5F),
          along(1) - (static_cast<float>(row) + 0.5F),
          along(2) - group.depth[lane]};
}

TileFoot foot_at(const CellGroup& group, std::uint32_t lane, const CellPatch& patch, float x,
                 float y) noexcept {
  TileFoot foot;
  foot.cell = cell_of(group, lane);
  foot.slope_eta = patch.slope_x + patch.twist * y;
  foot.slope_omega = patch.slope_y + patch.twist * x;
  foot.away_eta = (patch.dx - x) * group.spacing;
  foot.away_omega = (patch.dy - y) * group.spacing;
  foot.away_depth = (patch.dz - patch.height(x, y)) * group.spacing;
  settle_foot(foot, std::sqrt(patch.squared_distance(x, y)) * group.spacing);
  return foot;
}

}  // namespace

TileFoot foot_on_cell(const CellGroup& group, std::uint32_t lane, const Vector3& place, float x,
                      float y) noexcept {
  const CellPatch patch = patch_at(group, lane, place);
  const bool on_border = std::abs(x) == 0.5F || std::abs(y) == 0.5F;
  if (on_border && group.clips == 0) closest_on_patch(patch, x, y);
  return foot_at(group, lane, patch, x, y);
}

TileFoot closest_on_cell(const Tile& tile, const CellGroup& group, std::uint32_t lane,
                         const Vector3& place, float limit) noexcept {
  const CellPatch patch = patch_at(group, lane, place);
  float x = 0, y = 0;
  closest_on_patch(patch, x, y);
  TileFoot foot;
  foot.cell = cell_of(group, lane);
  if (((tile.clipped >> foot.cell) & 1U) != 0 &&
      !clip_foot(patch, cell_clip(tile, foot.cell), 1, x, y)) {
    return foot;
  }
  const float most = limit / group.spacing;
  if (!(patch.squared_distance(x, y) < most * most)) return foot;
  return foot_at(group, lane, patch, x, y);
}

}  // namespace spm
