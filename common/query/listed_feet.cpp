// SPDX-License-Identifier: Apache-2.0
#include "common/query/listed_feet.hpp"

#include <array>
#include <cmath>

#include "common/surface/cell_foot.hpp"
#include "common/surface/closest_on_tile.hpp"

namespace spm {

namespace {

void set_on_cell(const AssetView& asset, const IndexUnit& unit, const NearestUnit& found,
                 const Vector3& point, ElementFoot& foot) noexcept {
  const CellGroup& group = asset.index.groups.cells[unit.group];
  TileFoot& on = foot.on_tile;
  const bool on_border = std::abs(found.x) == 0.5F || std::abs(found.y) == 0.5F;
  if (on_border && group.clips == 0) {
    on = foot_on_cell(group, unit.lane, point - asset.tree.origin, found.x, found.y);
  } else {
    on.cell = cell_of(group, unit.lane);
    on.slope_eta = group.slope_eta[unit.lane] + group.twist[unit.lane] * found.y;
    on.slope_omega = group.slope_omega[unit.lane] + group.twist[unit.lane] * found.x;
    on.away_eta = found.away[0] * group.spacing;
    on.away_omega = found.away[1] * group.spacing;
    on.away_depth = found.away[2] * group.spacing;
    settle_foot(on, std::sqrt(found.square));
  }
  foot.tile = &asset.tiles[group.tile];
  foot.distance = static_cast<double>(on.distance);
  foot.along_normal = static_cast<double>(std::abs(on.below));
}

void set_on_triangle(const AssetView& asset, const IndexUnit& unit, const NearestUnit& found,
                     const Vector3& point, ElementFoot& foot) noexcept {
  const UnitGroups& groups = asset.index.groups;
  const TriangleGroup& group = groups.triangles[unit.group - groups.cells.size()];
  const auto vector = [&](const GroupVectors& from) {
    return Vector3(double{from[0][unit.lane]}, double{from[1][unit.lane]},
                   double{from[2][unit.lane]});
  };
  const Vector3 away(double{found.away[0]}, double{found.away[1]}, double{found.away[2]});
  // One without a direction may be the nearest, but faces nothing.
  const bool has_normal = group.least_share[unit.lane] < no_share;
  foot.tile = nullptr;
  foot.distance = static_cast<double>(std::sqrt(found.square));
  foot.on_triangle = point - away;
  foot.triangle_normal = has_normal ? vector(group.normal) : Vector3(Vector3::UnitZ());
  foot.along_normal = has_normal ? std::abs(foot.triangle_normal.dot(away)) : 0;
}

/// The foot that a unit of a list has; infinite where there is none.
void set_foot(const AssetView& asset, const GroupNames& names, const NearestUnit& found,
              const Vector3& point, ElementFoot& foot) noexcept {
  if (!found.is_found()) return;
  const IndexUnit unit = unit_at(names, found.which);
  if (unit.group < asset.index.groups.cells.size()) {
    set_on_cell(asset, unit, found, point, foot);
  } else {
    set_on_triangle(asset, unit, found, point, foot);
  }
}

}  // namespace

ElementFoot listed_nearest(const AssetView& asset, const IndexList& list,
                           const Vector3& point) noexcept {
  const GroupNames names = names_of(asset.index, list, list.nearest);
  ElementFoot foot;
  set_foot(asset, names, nearest_unit(asset.index.groups, names, from_origin(asset.tree, point)),
           point, foot);
  return foot;
}

ListedFeet listed_feet(const AssetView& asset, const IndexList& list,
                       const Vector3& point) noexcept {
  const GroupNames names = names_of(asset.index, list, list.nearest);
  return listed_feet(asset, list, point,
                     nearest_unit(asset.index.groups, names, from_origin(asset.tree, point)));
}

ListedFeet listed_feet(const AssetView& asset, const IndexList& list, const Vector3& point,
                       const NearestUnit& found) noexcept {
  ListedFeet feet;
  ElementFoot& nearest = feet.nearest;
  set_foot(asset, names_of(asset.index, list, list.nearest), found, point, nearest);
  if (nearest.along_normal >= facing_cosine * nearest.distance) return feet;
  const double most = nearest.distance + facing_tolerances * asset.tolerance;
  if (!std::isfinite(most)) return feet;
  const GroupNames all = names_of(asset.index, list, list.count);
  const NearestUnit facing = nearest_facing(asset.index.groups, all, from_origin(asset.tree, point),
                                            static_cast<float>(facing_cosine));
  if (double{facing.square} <= most * most) {
    set_foot(asset, all, facing, point, feet.facing.emplace());
  }
  return feet;
}

}  // namespace spm
