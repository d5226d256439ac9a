// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <algorithm>
#include <array>
#include <bit>
#include <cstddef>
#include <cstdint>
#include <span>

#include "common/asset/primitive_packets.hpp"
#include "common/surface/support_plane.hpp"

namespace spm {

/// A primitive, the part of an element that a query treats separately: a cell of a tile, or a
/// triangle.
struct IndexPrimitive {
  std::uint32_t packet = 0;
  std::uint32_t lane = 0;
};

/// What an index records of a whole cube.
enum class CubeKind : std::uint32_t {
  unknown = 0,   ///< the sign octree tells what a point is
  boundary = 1,  ///< as SignKind
  inside = 2,
  outside = 3,
  one_sided = 4,  ///< what is near looks one way: the nearest tells the side
  far = 5,        ///< outside, beyond the margin
  beside = 6,     ///< not in the grid: far, pruned, or deep in what was cut; in no word
};

/// Look-up table of the primitives of a `sparse` asset that can matter to a point, cube by cube. It
/// replaces the descent in an Bvh. Derived when an asset is opened (build_element_index),
/// never stored; without it queries descend the tree. Views; nothing is owned.
///
/// The cubes of a regular grid, x fastest, come first in `words`, one word each:
///   0: nothing recorded; the tree is searched;
///   bit 31 set: split; bits 0-30 the place of eight words like these, one per octant (bit 0: upper
///     half in x, 1: y, 2: z);
///   else bits 28-30: the CubeKind; where it is `far`, bits 0-27 are those of a float without its
///   last
///     four bits: a lower bound of the distance from the cube to the surface, m;
///   else bits 0-27: the place of a list: a word that counts its packets,
///     in bits 0-15 those that may hold the primitive nearest to a point of the cube, in bits 16-31
///     all; then their numbers, in that order, two of 16 bits per word, or one of 32 where there
///     are more than 65536 packets. The packets after the first ones matter where votes decide the
///     side, or where the nearest primitive does not face the point.
struct ElementIndex {
  Vector3 origin = Vector3::Zero();  ///< lowest corner of the grid, m
  double cell_size = 1;              ///< m
  double per_cell = 1;               ///< 1 / cell_size
  std::array<std::uint32_t, 3> cells{0, 0, 0};
  std::span<const std::uint32_t> words;
  double slack = 0;  ///< m: how far bounds of packets, which are floats, may be off
  PrimitivePackets packets;

  /// Whether numbers of packets are of 16 bits.
  [[nodiscard]] bool has_small_numbers() const noexcept {
    return packets.cells.size() + packets.triangles.size() <= (std::size_t{1} << 16U);
  }
};

inline constexpr std::uint32_t index_split = 1U << 31U;
inline constexpr std::uint32_t index_place = (1U << 28U) - 1;
inline constexpr int index_levels = 6;  ///< halvings of a cube of the grid at most

/// Packets that a list may name at most.
inline constexpr std::size_t index_list_packets = 64;

/// The list of a cube, as found for a point.
struct IndexList {
  const std::uint32_t* numbers = nullptr;  ///< null: the tree tells
  std::uint32_t nearest = 0;               ///< so many of the first may hold the nearest
  std::uint32_t count = 0;
  CubeKind kind = CubeKind::unknown;
  float beyond = 0;  ///< where the kind is `far`, m: the surface is no nearer
};

/// The word of a cube that is `far`.
[[nodiscard]] inline std::uint32_t far_word(float beyond) noexcept {
  return static_cast<std::uint32_t>(CubeKind::far) << 28U |
         std::bit_cast<std::uint32_t>(beyond) >> 4U;
}

/// The list that begins at a place of the words.
[[nodiscard]] inline IndexList list_from(const std::uint32_t* header, CubeKind kind) noexcept {
  return {header + 1, *header & 0xFFFFU, *header >> 16U, kind, 0};
}

/// What a cube's word tells, of one that is not split.
[[nodiscard]] inline IndexList list_of(const ElementIndex& index, std::uint32_t word) noexcept {
  if (word == 0 || (word & index_split) != 0) return {};
  const auto kind = static_cast<CubeKind>(word >> 28U);
  if (kind == CubeKind::far) return {nullptr, 0, 0, kind, std::bit_cast<float>(word << 4U)};
  return list_from(index.words.data() + (word & index_place), kind);
}

/// Where a point is in an index's grid, in the finest cubes along each axis.
struct FinestCube {
  std::array<std::uint32_t, 3> at{};
  std::size_t cell = 0;  ///< of the grid; 0 where the point is in none
  bool is_in = true;

  /// In place: a copy of what has just been written part by part is waited for.
  void find(const ElementIndex& index, const Vector3& point) noexcept {
    constexpr double finest = 1U << index_levels;
    cell = 0;
    is_in = true;
    for (std::size_t axis = 3; axis-- > 0;) {
      const int k = static_cast<int>(axis);
      const double position = (point[k] - index.origin[k]) * index.per_cell;
      const bool is_between = position >= 0 && position < static_cast<double>(index.cells[axis]);
      is_in = is_in && is_between;
      at[axis] = is_between ? static_cast<std::uint32_t>(position * finest) : 0;
      cell = cell * index.cells[axis] + (at[axis] >> index_levels);
    }
  }

  /// The octant that it lies in of a cube whose octants are halved so often still.
  [[nodiscard]] std::uint32_t octant(unsigned halvings_left) const noexcept {
    const auto upper = [&](std::size_t axis) { return (at[axis] >> halvings_left) & 1U; };
    return upper(0) | upper(1) << 1U | upper(2) << 2U;
  }
};
/// What is told of places outside the grid, which is about the band.
inline constexpr IndexList outside_grid{nullptr, 0, 0, CubeKind::beside, 0};

/// The list of the cube that a point lies in.
[[nodiscard]] inline IndexList list_at(const ElementIndex& index, const Vector3& point) noexcept {
  if (index.words.empty()) return {};
  FinestCube cube;
  cube.find(index, point);
  if (!cube.is_in) return outside_grid;
  std::uint32_t word = index.words[cube.cell];
  for (unsigned level = index_levels; level > 0 && (word & index_split) != 0; --level) {
    word = index.words[(word & ~index_split) + cube.octant(level - 1)];
  }
  return list_of(index, word);
}

/// list_at of several points, one step of each at a time: none waits for the memory of another.
inline constexpr std::size_t points_at_once = 32;
void lists_at(const ElementIndex& index, std::span<const Vector3> points,
              IndexList* lists) noexcept;

/// The first packets of a list, at most index_list_packets.
[[nodiscard]] inline PackedNumbers packed_numbers_of(const ElementIndex& index,
                                                     const IndexList& list,
                                                     std::size_t count) noexcept {
  return {list.numbers, std::min(count, index_list_packets), index.has_small_numbers()};
}

/// The primitive that a packet of a list and a lane name.
[[nodiscard]] inline IndexPrimitive primitive_at(const PackedNumbers& names,
                                                 std::size_t which) noexcept {
  return {names[which / packet_width], static_cast<std::uint32_t>(which % packet_width)};
}

/// Calls `visit(primitive)` for the primitives of a list that may lie nearer to a point (`place`, m
/// from the tree's origin) than `limit()` (m), which may shrink on the way: nearest bounds first.
template <class Visit, class Limit>
void visit_list(const ElementIndex& index, const IndexList& list, const std::array<float, 3>& place,
                const Visit& visit, const Limit& limit) noexcept {
  // Without initial values: only what is written is read.
  alignas(64) std::array<float, index_list_packets * packet_width> squares;
  std::array<std::uint32_t, (index_list_packets + 1) * packet_width> near;
  const PackedNumbers names = packed_numbers_of(index, list, list.count);
  if (names.size() == 0) return;
  const auto bound = [&limit, slack = index.slack] {
    const double farthest = limit() + slack;
    return static_cast<float>(farthest * farthest * (1 + 1e-6));
  };
  const std::uint32_t first = packet_squares(index.packets, names, place, squares.data());
  if (!(squares[first] <= bound()) || !(squares[first] < nothing_square)) return;
  visit(primitive_at(names, first));
  squares[first] = empty_square;
  float farthest = std::min(bound(), empty_square / 2);
  std::size_t left = near_lanes(squares.data(), names.size() * packet_width, farthest, near.data());
  while (left > 0) {
    std::size_t next = 0;
    for (std::size_t i = 1; i < left; ++i) {
      next = squares[near[i]] < squares[near[next]] ? i : next;
    }
    const std::size_t which = near[next];
    near[next] = near[--left];
    if (!(squares[which] <= farthest)) return;
    visit(primitive_at(names, which));
    farthest = std::min(bound(), empty_square / 2);
  }
}

}  // namespace spm
