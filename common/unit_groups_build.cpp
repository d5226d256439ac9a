// SPDX-License-Identifier: Apache-2.0
#include "common/unit_groups_build.hpp"

#include <algorithm>

#include "common/closest_element.hpp"

namespace spm {

namespace {

/// Puts a vector into a lane.
void put(std::array<GroupLanes, 3>& to, std::size_t lane, const Vector3& from) {
  for (int axis = 0; axis < 3; ++axis) {
    to[static_cast<std::size_t>(axis)][lane] = static_cast<float>(from[axis]);
  }
}

}  // namespace

void order_by_place(std::span<ElementUnit> units) {
  if (units.size() <= group_units) return;
  // Halved along the longest side of the box around all, at a multiple of a group.
  Vector3 low = units.front().box.middle, high = low;
  for (const ElementUnit& unit : units) {
    low = low.cwiseMin(unit.box.middle);
    high = high.cwiseMax(unit.box.middle);
  }
  Eigen::Index axis = 0;
  (high - low).maxCoeff(&axis);
  const std::size_t half = (units.size() / 2 + group_units - 1) / group_units * group_units;
  std::nth_element(units.begin(), units.begin() + static_cast<std::ptrdiff_t>(half), units.end(),
                   [axis](const ElementUnit& a, const ElementUnit& b) {
                     return a.box.middle[axis] < b.box.middle[axis];
                   });
  order_by_place(units.first(half));
  order_by_place(units.subspan(half));
}

std::vector<BoxGroup> box_groups(const AssetView& asset, std::span<const ElementUnit> blocks) {
  BoxGroup empty;
  empty.offset[0].fill(empty_lane);
  std::vector<BoxGroup> groups((blocks.size() + group_units - 1) / group_units, empty);
  for (std::size_t i = 0; i < blocks.size(); ++i) {
    BoxGroup& group = groups[i / group_units];
    const std::size_t lane = i % group_units;
    const OrientedBox& box = blocks[i].box;
    for (int axis = 0; axis < 3; ++axis) {
      put(group.axes[static_cast<std::size_t>(axis)], lane, box.axes.col(axis));
    }
    put(group.offset, lane, box.axes.transpose() * (asset.tree.origin - box.middle));
    put(group.half, lane, box.half);
    group.quarters[lane] = blocks[i].name.element * tile_quarters + blocks[i].name.part;
  }
  return groups;
}

std::vector<TriangleGroup> triangle_groups(const AssetView& asset,
                                           std::span<const ElementUnit> triangles) {
  TriangleGroup empty;
  empty.corner[0].fill(empty_lane);
  std::vector<TriangleGroup> groups((triangles.size() + group_units - 1) / group_units, empty);
  for (std::size_t i = 0; i < triangles.size(); ++i) {
    TriangleGroup& group = groups[i / group_units];
    const std::size_t lane = i % group_units;
    group.first[lane] = triangles[i].name.element;
    group.second[lane] = triangles[i].name.part & ~index_triangle;
    Vector3 a, b, c;
    if (!stored_corner(asset, group.first[lane], a) ||
        !stored_corner(asset, group.second[lane], b) ||
        !stored_corner(asset, group.second[lane] + 1, c)) {
      continue;
    }
    put(group.corner, lane, a - asset.tree.origin);
    put(group.side, lane, b - a);
    put(group.other, lane, c - a);
  }
  return groups;
}

}  // namespace spm
