// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <bit>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <limits>
#include <span>
#include <utility>

#include "common/element_tree.hpp"
#include "common/support_plane.hpp"
#include "common/tile.hpp"

namespace spm {

/// Four floats that are worked on at once.
using FourLanes = float __attribute__((vector_size(16)));

/// An oriented box around an element. A place p, m from the tree's origin, has in its frame the
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

/// Which elements of a `sparse` asset can matter to a point, cube by cube: what an ElementTree
/// tells by descending, looked up. Derived when an asset is opened (build_element_index), never
/// stored; without it queries descend the tree, with the same answers. Views; nothing is owned.
///
/// Cubes of a regular grid, x fastest, come first in `words`, a word each:
///   0: not told here; the tree tells;
///   bit 31 set: split; bits 0-30 the place of eight words like these, one an octant (bit 0: upper
///     half in x, 1: y, 2: z);
///   else the place of a list: a word that counts its elements; the bits of a float, the signed
///     distance of the cube's middle, m, or NaN where that may not tell the side; then the
///     elements' numbers, two of 16 bits a word, or one of 32 where there are more than 65536.
struct ElementIndex {
  Vector3 origin = Vector3::Zero();  ///< lowest corner of the grid, m
  double cell_size = 1;              ///< m
  std::array<std::uint32_t, 3> cells{0, 0, 0};
  std::span<const std::uint32_t> words;
  std::span<const std::uint32_t> elements;  ///< as in the tree, by number
  std::span<const ElementBox> boxes;        ///< likewise
  std::span<const BlockPlanes> blocks;      ///< of the asset's tiles
};

inline constexpr std::uint32_t index_split = 1U << 31U;
inline constexpr int index_levels = 4;  ///< halvings of a cube of the grid at most
inline constexpr std::size_t index_header_words = 2;
inline constexpr std::size_t index_list_elements = 64;  ///< at most
inline constexpr std::size_t small_elements = 65536;    ///< numbers below fit in 16 bits

/// The list of a cube, as found for a point.
struct IndexList {
  const std::uint32_t* numbers = nullptr;  ///< null: the tree tells
  std::uint32_t count = 0;
  /// How far the point is from where inside and outside meet, at least, m, negative inside; NaN
  /// where that is not known.
  float clearance = std::numeric_limits<float>::quiet_NaN();
};

/// The list of the cube that a point lies in.
[[nodiscard]] inline IndexList list_at(const ElementIndex& index, const Vector3& point) noexcept {
  if (index.words.empty()) return {};
  std::size_t cell = 0;
  std::array<double, 3> within{};
  double edge = index.cell_size;
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
    edge /= 2;
  }
  if (word == 0 || (word & index_split) != 0) return {};
  const std::uint32_t* header = index.words.data() + word;
  const auto middle = std::bit_cast<float>(header[1]);
  const double x = within[0] - 0.5, y = within[1] - 0.5, z = within[2] - 0.5;
  const auto away = static_cast<float>(edge * std::sqrt(x * x + y * y + z * z));
  IndexList list;
  list.numbers = header + index_header_words;
  list.count = header[0];
  if (away < std::abs(middle)) list.clearance = std::copysign(std::abs(middle) - away, middle);
  return list;
}

/// Calls `visit(child)` for the elements of a list that may lie nearer to a point than `limit()`
/// (m), which may shrink on the way: the one with the nearest box first, then the others as listed.
template <class Visit, class Limit>
void visit_list(const ElementIndex& index, const IndexList& list, const std::array<float, 3>& place,
                const Visit& visit, const Limit& limit) noexcept {
  struct Near {
    float square;
    std::uint32_t number;
  };
  std::array<Near, index_list_elements> near;
  const bool small = index.elements.size() <= small_elements;
  const std::size_t count = list.count <= index_list_elements ? list.count : index_list_elements;
  std::size_t kept = 0, first = 0;
  const auto start = static_cast<float>(limit() * limit() * (1 + 1e-6));
  for (std::size_t i = 0; i < count; ++i) {
    const std::uint32_t number =
        small ? (list.numbers[i / 2] >> (16 * (i & 1U))) & 0xFFFFU : list.numbers[i];
    const float square = squared_distance(index.boxes[number], place);
    near[kept] = {square, number};
    if (square < near[first].square) first = kept;
    kept += square <= start ? 1 : 0;
  }
  if (kept == 0) return;
  std::swap(near[0], near[first]);
  for (std::size_t i = 0; i < kept; ++i) {
    const double reach = limit();
    if (!(static_cast<double>(near[i].square) <= reach * reach)) continue;
    visit(unpack_child(index.elements[near[i].number]));
  }
}

}  // namespace spm
