// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <cstdint>
#include <span>

#include "common/field/distance_octree.hpp"

namespace spm {

/// Triangles that are asked at once.
inline constexpr std::size_t packet_size = 8;
/// Lists of no more packets are looked at whole.
inline constexpr std::size_t unbounded_packets = 2;
/// The most triangles of solids, and of sheets, that a list can have.
inline constexpr std::uint32_t max_listed_of_kind = 0x3FFF;

[[nodiscard]] constexpr std::size_t packets_of(std::size_t triangles) noexcept {
  return (triangles + packet_size - 1) / packet_size;
}

/// The triangles among which the nearest one of any place of a cube is.
///
/// Words of a list: word 0 is a number; then the triangles as numbers to add to it, those of
/// solids first, then the sheets: two of 16 bits a word, the low half first, or, of a wide list,
/// one a word. Then, where there are more packets of eight than unbounded_packets, for each packet
/// of solids and each of sheets a byte, lowest first: how far its triangles are at least from every
/// point of the cube, in 1/255 of the octree's `reach`, ascending within each kind.
///
/// Second word of its unit: bits 0-13 the number of triangles of solids, bits 14-27 that of sheets,
/// bits 28-29 the ListSide of the solids, bit 30 set where the list is wide.
struct TriangleList {
  std::uint32_t solids = 0, sheets = 0;
  ListSide side = ListSide::surface;
  bool wide = false;
  const std::uint32_t* words = nullptr;

  [[nodiscard]] std::size_t size() const noexcept { return std::size_t{solids} + sheets; }
  [[nodiscard]] std::size_t packets() const noexcept {
    return packets_of(solids) + packets_of(sheets);
  }
  [[nodiscard]] bool has_bounds() const noexcept { return packets() > unbounded_packets; }
  /// Words before those of the bounds.
  [[nodiscard]] std::size_t number_words() const noexcept {
    return 1 + (wide ? size() : (size() + 1) / 2);
  }
  [[nodiscard]] std::size_t word_count() const noexcept {
    return number_words() + (has_bounds() ? (packets() + 3) / 4 : 0);
  }
  /// The k-th triangle.
  [[nodiscard]] std::uint32_t triangle(std::size_t k) const noexcept {
    return words[0] + (wide ? words[1 + k] : (words[1 + k / 2] >> 16U * (k % 2) & 0xFFFFU));
  }
  /// The bound of a packet, counted over the solids and then the sheets; of lists that have bounds.
  [[nodiscard]] std::uint32_t bound(std::size_t packet) const noexcept {
    return words[number_words() + packet / 4] >> 8U * (packet % 4) & 0xFFU;
  }
};

[[nodiscard]] constexpr std::uint32_t list_word(std::uint32_t solids, std::uint32_t sheets,
                                                ListSide side, bool wide) noexcept {
  return solids | sheets << 14U | static_cast<std::uint32_t>(side) << 28U | (wide ? 1U << 30U : 0U);
}

/// The list that a unit names; without triangles where it is not there whole.
[[nodiscard]] inline TriangleList list_of(const DistanceOctree& octree,
                                          const std::uint32_t* unit) noexcept {
  TriangleList list;
  list.solids = unit[1] & max_listed_of_kind;
  list.sheets = unit[1] >> 14U & max_listed_of_kind;
  list.side = static_cast<ListSide>(unit[1] >> 28U & 3U);
  list.wide = (unit[1] >> 30U & 1U) != 0;
  const std::size_t first = unit[0];
  if (first > octree.lists.size() || list.word_count() > octree.lists.size() - first) return {};
  list.words = octree.lists.data() + first;
  return list;
}

}  // namespace spm
