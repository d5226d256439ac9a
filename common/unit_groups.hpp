// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <span>

#include "common/cell_group.hpp"

namespace spm {

/// Eight triangles: a corner, m from the tree's origin, and from it two sides. A lane without a
/// triangle is out of all reach.
struct alignas(64) TriangleGroup {
  std::array<GroupLanes, 3> corner{}, side{}, other{};
  /// The first stored corner, and the second, which the third follows.
  std::array<std::uint32_t, group_units> first{}, second{};
};

/// How far a lane lies that has nothing, m, and its square, a float still.
inline constexpr float empty_lane = 1e15F;
inline constexpr float empty_square = empty_lane * empty_lane;

/// Groups that a number names: below `cells.size()` one of cells, beyond one of triangles.
struct UnitGroups {
  std::span<const CellGroup> cells;
  std::span<const ClipGroup> clips;  ///< of those that have clipped cells
  std::span<const TriangleGroup> triangles;
};

/// A unit of a list of groups: `group_units` times the group's place in the list, and the lane.
struct NearestUnit {
  std::uint32_t which = 0;
  float square = empty_square;  ///< of its distance, m^2; that and more where there is none
  float x = 0, y = 0;           ///< on a cell the foot, from its middle, spacings
};

/// Finds the unit of groups that is nearest to a place (m from the tree's origin): the first of
/// equals, but for rounding. Each group fills `group_units` of `squares`, m^2, which are aligned as
/// groups are. Numbers of no group are out of all reach. Several units at once by
/// whatever the processor has; the same bits on each.
[[nodiscard]] NearestUnit nearest_unit(const UnitGroups& groups,
                                       std::span<const std::uint32_t> numbers,
                                       const std::array<float, 3>& place, float* squares) noexcept;

/// As nearest_unit, and gives for each group the square of the distance of its nearest unit, m^2.
[[nodiscard]] NearestUnit nearest_of_groups(const UnitGroups& groups,
                                            std::span<const std::uint32_t> numbers,
                                            const std::array<float, 3>& place,
                                            float* squares) noexcept;

/// What nearest_facing looks for.
struct FacingQuery {
  float cosine = 1;                ///< how well a foot's own normal meets the place
  float square = 0;                ///< of how far it may be, m^2
  std::size_t known = 0;           ///< so many of the first groups
  const float* squares = nullptr;  ///< have these squares at least
};

/// As nearest_unit, of those units whose feet's own normals meet the place.
[[nodiscard]] NearestUnit nearest_facing(const UnitGroups& groups,
                                         std::span<const std::uint32_t> numbers,
                                         const std::array<float, 3>& place,
                                         const FacingQuery& query) noexcept;

/// Finds the squares of lower bounds of the distances of a place to the units of groups, m^2; each
/// group fills `group_units` of `squares`, which are aligned as groups are. Gives where the least
/// is. As nearest_unit else.
[[nodiscard]] std::uint32_t group_squares(const UnitGroups& groups,
                                          std::span<const std::uint32_t> numbers,
                                          const std::array<float, 3>& place,
                                          float* squares) noexcept;

/// Lists in `places` which of `count` squares (whole groups) are no larger than `farthest`, in
/// order, and gives how many. What follows them in `places`, up to `count` and a group more, may be
/// written over.
[[nodiscard]] std::size_t near_lanes(const float* squares, std::size_t count, float farthest,
                                     std::uint32_t* places) noexcept;

}  // namespace spm
