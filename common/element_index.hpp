// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <span>
#include <utility>

#include "common/support_plane.hpp"
#include "common/tile_quarter.hpp"

namespace spm {

/// Four floats that are worked on at once.
using FourLanes = float __attribute__((vector_size(16)));

/// An oriented box around a unit. A place p, m from the tree's origin, has in its frame the
/// coordinates x * p.x + y * p.y + z * p.z + offset, from the box's middle; the fourth of each is
/// 0.
struct ElementBox {
  FourLanes x{}, y{}, z{}, offset{};
  FourLanes half{};  ///< m
};

/// Square of the distance of a place to a box, m^2.
[[nodiscard]] inline float squared_distance(const ElementBox& box,
                                            const std::array<float, 3>& place) noexcept {
  const FourLanes at = box.x * place[0] + box.y * place[1] + box.z * place[2] + box.offset;
  const FourLanes size = at < 0 ? -at : at;
  const FourLanes off = size > box.half ? size - box.half : FourLanes{};
  const FourLanes square = off * off;
  return square[0] + square[1] + square[2];
}

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
///   else bits 28-30: the CubeKind; bits 0-27: the place of a list: a word that counts its units,
///     then their numbers, two of 16 bits a word, or one of 32 where there are more than 65536.
struct ElementIndex {
  Vector3 origin = Vector3::Zero();  ///< lowest corner of the grid, m
  double cell_size = 1;              ///< m
  std::array<std::uint32_t, 3> cells{0, 0, 0};
  std::span<const std::uint32_t> words;
  std::span<const IndexUnit> units;       ///< by number
  std::span<const ElementBox> boxes;      ///< likewise
  std::span<const TileQuarter> quarters;  ///< four a tile
};

inline constexpr std::uint32_t index_split = 1U << 31U;
inline constexpr std::uint32_t index_place = (1U << 28U) - 1;
inline constexpr int index_levels = 4;                ///< halvings of a cube of the grid at most
inline constexpr std::size_t index_list_units = 128;  ///< at most
inline constexpr std::size_t small_units = 65536;     ///< numbers below fit in 16 bits

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
  for (std::size_t axis = 3; axis-- > 0;) {
    const int k = static_cast<int>(axis);
    const double position = (point[k] - index.origin[k]) / index.cell_size;
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

/// Calls `visit(unit)` for the units of a list that may lie nearer to a point than `limit()` (m),
/// which may shrink on the way, nearest boxes first.
template <class Visit, class Limit>
void visit_list(const ElementIndex& index, const IndexList& list, const std::array<float, 3>& place,
                const Visit& visit, const Limit& limit) noexcept {
  struct Near {
    float square;
    std::uint32_t number;
  };
  std::array<Near, index_list_units> near;
  const bool small = index.units.size() <= small_units;
  const std::size_t count = list.count <= index_list_units ? list.count : index_list_units;
  std::size_t first = 0;
  for (std::size_t i = 0; i < count; ++i) {
    const std::uint32_t number =
        small ? (list.numbers[i / 2] >> (16 * (i & 1U))) & 0xFFFFU : list.numbers[i];
    const float square = squared_distance(index.boxes[number], place);
    near[i] = {square, number};
    first = square < near[first].square ? i : first;
  }
  // Nearest first: a visit costs more than to look for the next.
  for (std::size_t left = count; left > 0;) {
    std::swap(near[0], near[first]);
    const double start = limit();
    if (!(static_cast<double>(near[0].square) <= start * start)) return;
    visit(index.units[near[0].number]);
    const double reach = limit();
    const auto farthest = static_cast<float>(reach * reach * (1 + 1e-6));
    std::size_t kept = 0;
    first = 0;
    for (std::size_t i = 1; i < left; ++i) {
      const Near next = near[i];
      near[kept] = next;
      first = next.square < near[first].square ? kept : first;
      kept += next.square <= farthest ? 1 : 0;
    }
    left = kept;
  }
}

}  // namespace spm
