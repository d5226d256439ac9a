// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <algorithm>
#include <array>
#include <cstddef>
#include <cstdint>
#include <span>

#include "common/support_plane.hpp"
#include "common/tile_quarter.hpp"
#include "common/unit_groups.hpp"

namespace spm {

/// A part of an element that queries look at by itself: a quarter of a tile, or a triangle.
struct IndexUnit {
  std::uint32_t element = 0;  ///< the tile; or the triangle's first stored corner
  std::uint32_t part = 0;     ///< the quarter; or index_triangle and the second corner, which the
                              ///< third follows
};
inline constexpr std::uint32_t index_triangle = 1U << 31U;

/// What an index tells of a whole cube.
enum class CubeKind : std::uint32_t {
  unknown = 0,  ///< the space tree tells what a point is
  told = 1,     ///< as SpaceKind
  inside = 2,
  outside = 3,
  one_sheet = 4,  ///< what is near looks one way: the nearest tells the side
};

/// Which parts of elements of a `sparse` asset can matter to a point, cube by cube: what an
/// ElementTree tells by descending, looked up. Derived when an asset is opened
/// (build_element_index), never stored; without it queries descend the tree. Views; nothing is
/// owned.
///
/// Cubes of a regular grid, x fastest, come first in `words`, a word each:
///   0: not told here; the tree tells;
///   bit 31 set: split; bits 0-30 the place of eight words like these, one an octant (bit 0: upper
///     half in x, 1: y, 2: z);
///   else bits 28-30: the CubeKind; bits 0-27: the place of a list: a word that counts its groups,
///     then their numbers, two of 16 bits a word, or one of 32 where there are more than 65536.
///     Groups of boxes come first, then those of triangles.
struct ElementIndex {
  Vector3 origin = Vector3::Zero();  ///< lowest corner of the grid, m
  double cell_size = 1;              ///< m
  std::array<std::uint32_t, 3> cells{0, 0, 0};
  std::span<const std::uint32_t> words;
  double slack = 0;  ///< m: how far bounds of groups, which are floats, may be off
  std::span<const BoxGroup> boxes;
  std::span<const TriangleGroup> triangles;
  std::span<const TileQuarter> quarters;  ///< four a tile
};

inline constexpr std::uint32_t index_split = 1U << 31U;
inline constexpr std::uint32_t index_place = (1U << 28U) - 1;
inline constexpr int index_levels = 6;              ///< halvings of a cube of the grid at most
inline constexpr std::size_t small_groups = 65536;  ///< numbers below fit in 16 bits

/// The list of a cube, as found for a point.
struct IndexList {
  const std::uint32_t* numbers = nullptr;  ///< null: the tree tells
  std::uint32_t count = 0;
  CubeKind kind = CubeKind::unknown;
};

/// The list of the cube that a point lies in.
[[nodiscard]] inline IndexList list_at(const ElementIndex& index, const Vector3& point) noexcept {
  if (index.words.empty()) return {};
  std::size_t cell = 0;
  std::array<double, 3> within{};
  const double per_cell = 1 / index.cell_size;
  for (std::size_t axis = 3; axis-- > 0;) {
    const int k = static_cast<int>(axis);
    const double position = (point[k] - index.origin[k]) * per_cell;
    if (!(position >= 0 && position < static_cast<double>(index.cells[axis]))) return {};
    const auto whole = static_cast<std::size_t>(position);
    cell = cell * index.cells[axis] + whole;
    within[axis] = position - static_cast<double>(whole);
  }
  std::uint32_t word = index.words[cell];
  for (int level = 0; level < index_levels && (word & index_split) != 0; ++level) {
    std::uint32_t octant = 0;
    for (std::size_t axis = 0; axis < 3; ++axis) {
      within[axis] *= 2;
      if (within[axis] < 1) continue;
      within[axis] -= 1;
      octant |= 1U << axis;
    }
    word = index.words[(word & ~index_split) + octant];
  }
  if (word == 0 || (word & index_split) != 0) return {};
  const std::uint32_t* header = index.words.data() + (word & index_place);
  return {header + 1, header[0], static_cast<CubeKind>(word >> 28U)};
}

/// The unit in a lane of a group.
[[nodiscard]] inline IndexUnit unit_at(const ElementIndex& index, std::uint32_t group,
                                       std::uint32_t lane) noexcept {
  if (group < index.boxes.size()) {
    const std::uint32_t quarter = index.boxes[group].quarters[lane];
    return {quarter / tile_quarters, quarter % tile_quarters};
  }
  const TriangleGroup& triangles = index.triangles[group - index.boxes.size()];
  return {triangles.first[lane], triangles.second[lane] | index_triangle};
}

/// Calls `visit(unit)` for the units of a list that may lie nearer to a point (`place`, m from the
/// tree's origin) than `limit()` (m), which may shrink on the way: nearest bounds first.
template <class Visit, class Limit>
void visit_list(const ElementIndex& index, const IndexList& list, const std::array<float, 3>& place,
                const Visit& visit, const Limit& limit) noexcept {
  // Without initial values: only what is written is read.
  alignas(64) std::array<float, index_list_groups * group_units> squares;
  std::array<std::uint32_t, index_list_groups> numbers;
  std::array<std::uint32_t, (index_list_groups + 1) * group_units> near;
  const bool small = index.boxes.size() + index.triangles.size() <= small_groups;
  const std::size_t groups = list.count <= index_list_groups ? list.count : index_list_groups;
  if (groups == 0) return;
  for (std::size_t i = 0; i < groups; ++i) {
    numbers[i] = small ? (list.numbers[i / 2] >> (16 * (i & 1U))) & 0xFFFFU : list.numbers[i];
  }
  const auto reach = [&limit, slack = index.slack] {
    const double farthest = limit() + slack;
    return static_cast<float>(farthest * farthest * (1 + 1e-6));
  };
  const auto unit = [&](std::size_t which) {
    return unit_at(index, numbers[which / group_units], which % group_units);
  };
  const std::uint32_t first =
      group_squares(index.boxes, index.triangles, {numbers.data(), groups}, place, squares.data());
  if (!(squares[first] <= reach()) || !(squares[first] < empty_square)) return;
  visit(unit(first));
  squares[first] = empty_square;
  float farthest = std::min(reach(), empty_square / 2);
  std::size_t left = near_lanes(squares.data(), groups * group_units, farthest, near.data());
  while (left > 0) {
    std::size_t next = 0;
    for (std::size_t i = 1; i < left; ++i) {
      next = squares[near[i]] < squares[near[next]] ? i : next;
    }
    const std::size_t which = near[next];
    near[next] = near[--left];
    if (!(squares[which] <= farthest)) return;
    visit(unit(which));
    farthest = std::min(reach(), empty_square / 2);
  }
}

}  // namespace spm
