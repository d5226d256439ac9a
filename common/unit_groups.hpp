// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <span>

namespace spm {

/// How many units of an index are looked at together.
inline constexpr std::size_t group_units = 8;
/// Groups that a list may name at most.
inline constexpr std::size_t index_list_groups = 64;

/// A number for each unit of a group.
using GroupLanes = std::array<float, group_units>;

/// Oriented boxes around eight blocks of cells of tiles' quarters. A place p, m from the tree's
/// origin, has in box k's frame the coordinates `axes[i][0][k] * p.x + axes[i][1][k] * p.y +
/// axes[i][2][k] * p.z + offset[i][k]` from its middle, i = 0 to 2. A lane without a block is out
/// of all reach.
struct alignas(64) BoxGroup {
  std::array<std::array<GroupLanes, 3>, 3> axes{};
  std::array<GroupLanes, 3> offset{}, half{};
  std::array<std::uint32_t, group_units> quarters{};  ///< number of the tile * 4 + quarter
};

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

/// Finds the squares of lower bounds of the distances of a place (m from the tree's origin) to the
/// units of groups, m^2: `numbers` names boxes, and beyond them triangles; each fills `group_units`
/// of `squares`, which are aligned as groups are. Numbers of no group are out of all reach. Gives
/// where the least is. Several units at once by whatever the processor has; the same bits on each.
[[nodiscard]] std::uint32_t group_squares(std::span<const BoxGroup> boxes,
                                          std::span<const TriangleGroup> triangles,
                                          std::span<const std::uint32_t> numbers,
                                          const std::array<float, 3>& place,
                                          float* squares) noexcept;

/// Lists in `places` which of `count` squares (whole groups) are no larger than `farthest`, in
/// order, and gives how many. What follows them in `places`, up to `count` and a group more, may be
/// written over.
[[nodiscard]] std::size_t near_lanes(const float* squares, std::size_t count, float farthest,
                                     std::uint32_t* places) noexcept;

}  // namespace spm
