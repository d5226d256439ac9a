// SPDX-License-Identifier: Apache-2.0
#include "common/index/octant_lists.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <optional>
#include <span>

#include "common/query/closest_element.hpp"
#include "common/surface/closest_on_tile.hpp"
#include "common/surface/closest_on_triangle.hpp"

namespace spm {

namespace {

/// Places along an edge of a cube that are corners of its octants, and in all.
constexpr unsigned side = 3, places = side * side * side;

/// The place of the surface that is a unit's foot of a point; nothing where nothing is left of it.
std::optional<Vector3> foot_on(const AssetView& asset, const UnitGroupsData& units,
                               const IndexUnit& unit, const Vector3& point) {
  if (unit.group < units.cells.size()) {
    const CellGroup& group = units.cells[unit.group];
    const Tile& tile = asset.tiles[group.tile];
    const TileFoot foot = closest_on_cell(tile, group, unit.lane, point - asset.tree.origin,
                                          std::numeric_limits<float>::infinity());
    if (!std::isfinite(foot.distance)) return std::nullopt;
    return point - from_plane_frame(asset.planes[tile.plane], double{foot.away_eta},
                                    double{foot.away_omega}, double{foot.away_depth});
  }
  const TriangleGroup& group = units.triangles[unit.group - units.cells.size()];
  Vector3 a, b, c;
  if (!stored_corner(asset, group.first[unit.lane], a) ||
      !stored_corner(asset, group.second[unit.lane], b) ||
      !stored_corner(asset, group.second[unit.lane] + 1, c)) {
    return std::nullopt;
  }
  return closest_on_triangle(point, a, b, c);
}

/// Corners of octants, what is nearest to them, and the squares of how far each group is.
struct Corners {
  std::array<Vector3, places> at;
  std::array<std::optional<Vector3>, places> feet;
  std::array<std::array<float, places>, index_list_groups> squares;
};

/// `surface`: so many of the groups are not of caps, which are no surface.
void look_from_corners(const AssetView& asset, const UnitGroupsData& units,
                       const GroupNumbers& some, std::size_t surface, Corners& corners) {
  for (unsigned k = 0; k < places; ++k) {
    std::array<float, index_list_groups> found;
    const std::array<float, 3> place = from_origin(asset.tree, corners.at[k]);
    const NearestUnit nearest =
        nearest_of_groups(units.view(), std::span(some).first(surface), place, found.data());
    static_cast<void>(nearest_of_groups(units.view(), std::span(some).subspan(surface), place,
                                        found.data() + surface));
    for (std::size_t i = 0; i < some.size(); ++i) corners.squares[i][k] = found[i];
    if (!nearest.is_found()) continue;
    corners.feet[k] = foot_on(asset, units,
                              {some[nearest.which / group_units],
                               static_cast<std::uint32_t>(nearest.which % group_units)},
                              corners.at[k]);
  }
}

/// A place of the surface, from the corners of an octant.
struct KnownPlace {
  GroupLanes squares;   ///< of its distances, m^2
  double farthest = 0;  ///< of its distances, m
};

KnownPlace known_place(const Corners& corners, const std::array<unsigned, 8>& own,
                       const Vector3& foot, double rounding) {
  KnownPlace known;
  for (unsigned k = 0; k < own.size(); ++k) {
    const double distance = (corners.at[own[k]] - foot).norm() + rounding;
    known.squares[k] = static_cast<float>(distance * distance);
    known.farthest = std::max(known.farthest, distance);
  }
  return known;
}

}  // namespace

std::array<IndexLists, 8> octant_lists(const AssetView& asset, const UnitGroupsData& units,
                                       const Vector3& middle, double half, const GroupNumbers& some,
                                       double slack, double rounding) {
  Corners corners;
  for (unsigned k = 0; k < places; ++k) {
    const Vector3 steps(k % side, k / side % side, k / (side * side));
    corners.at[k] = middle + half * (steps - Vector3::Ones());
  }
  const auto surface = static_cast<std::size_t>(
      std::lower_bound(some.begin(), some.end(), units.first_cap) - some.begin());
  look_from_corners(asset, units, some, surface, corners);
  std::array<IndexLists, 8> lists;
  for (unsigned octant = 0; octant < lists.size(); ++octant) {
    std::array<unsigned, 8> own;
    for (unsigned k = 0; k < own.size(); ++k) {
      const auto step = [&](unsigned axis) { return ((octant >> axis) & 1U) + ((k >> axis) & 1U); };
      own[k] = step(0) + side * (step(1) + side * step(2));
    }
    std::array<KnownPlace, 8> known;
    std::size_t count = 0;
    for (const unsigned from : own) {
      if (corners.feet[from]) {
        known[count++] = known_place(corners, own, *corners.feet[from], rounding);
      }
    }
    for (std::size_t i = 0; i < some.size(); ++i) {
      bool nearest = i < surface, near = true;
      for (std::size_t j = 0; j < count && near; ++j) {
        float least = empty_square;
        for (unsigned k = 0; k < own.size(); ++k) {
          least = std::min(least, corners.squares[i][own[k]] - known[j].squares[k]);
        }
        nearest = nearest && !(least >= 0);
        near = !(double{least} >= slack * (2 * known[j].farthest + slack));
      }
      if (!near) continue;
      lists[octant].all.push_back(some[i]);
      if (nearest) lists[octant].nearest.push_back(some[i]);
    }
  }
  return lists;
}

}  // namespace spm
