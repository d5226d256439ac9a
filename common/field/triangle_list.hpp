// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <cstdint>
#include <optional>
#include <span>

#include "common/field/distance_octree.hpp"

namespace spm {

/// Triangles that are asked at once.
inline constexpr std::size_t packet_size = 8;
/// Lists of no more packets are looked at whole.
inline constexpr std::size_t unbounded_packets = 2;
/// The most triangles of solids, and of sheets, that a list can have.
inline constexpr std::uint32_t max_listed_of_kind = 0x1FFF;

[[nodiscard]] constexpr std::size_t packets_of(std::size_t triangles) noexcept {
  return (triangles + packet_size - 1) / packet_size;
}

/// Bits of a list's first word: the number that is added to all, and how many are crossed alone.
inline constexpr unsigned list_first_bits = 22;
inline constexpr std::uint32_t list_first_mask = (1U << list_first_bits) - 1;
inline constexpr std::uint32_t max_crossed = (1U << (32 - list_first_bits)) - 1;

/// A place of a cube, the side of which is known.
struct KnownPlace {
  std::uint32_t place = 0;  ///< a corner's octant (octant.hpp), or eight for the middle
  bool inside = false;      ///< of the solids
};
inline constexpr std::uint32_t places_of_cube = 9;

/// What a list tells of sides: that of all places (not on both sides of the surface), or that of
/// one place, or nothing.
[[nodiscard]] constexpr std::uint32_t list_side_code(
    ListSide side, const std::optional<KnownPlace>& known) noexcept {
  if (!known) return static_cast<std::uint32_t>(side);
  return 3 + 2 * known->place + (known->inside ? 1U : 0U);
}
inline constexpr std::uint32_t list_side_codes = 3 + 2 * places_of_cube;

/// The triangles among which the nearest one of any place of a cube is.
///
/// Words of a list: word 0 is a number of 22 bits, and above it how many triangles are there for
/// their crossings alone; then the triangles as numbers to add to the first, those of solids first,
/// then the sheets, then those: two of 16 bits a word, the low half first, or, of a wide list,
/// one a word. Then, where there are more packets of eight than unbounded_packets, for each packet
/// of solids and each of sheets a byte, lowest first: how far its triangles are at least from every
/// point of the cube, in 1/255 of the octree's `reach`, ascending within each kind.
///
/// Second word of its cube: bits 0-12 the number of triangles of solids, bits 13-25 that of sheets,
/// bits 26-30 what is known of sides (list_side_code), bit 31 set where the list is wide.
///
/// By side_by_crossings tells those that are there for it alone, or else those of solids: all that
/// pass the cube.
struct TriangleList {
  std::uint32_t solids = 0, sheets = 0, crossed = 0;
  ListSide side = ListSide::surface;
  std::optional<KnownPlace> known = std::nullopt;  ///< where the surface passes
  bool wide = false;
  const std::uint32_t* words = nullptr;

  [[nodiscard]] std::size_t size() const noexcept { return std::size_t{solids} + sheets + crossed; }
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
    return (words[0] & list_first_mask) +
           (wide ? words[1 + k] : (words[1 + k / 2] >> 16U * (k % 2) & 0xFFFFU));
  }
  /// The bound of a packet, counted over the solids and then the sheets; of lists that have bounds.
  [[nodiscard]] std::uint32_t bound(std::size_t packet) const noexcept {
    return words[number_words() + packet / 4] >> 8U * (packet % 4) & 0xFFU;
  }
};

[[nodiscard]] constexpr std::uint32_t list_word(
    std::uint32_t solids, std::uint32_t sheets, ListSide side, bool wide,
    const std::optional<KnownPlace>& known = std::nullopt) noexcept {
  return solids | sheets << 13U | list_side_code(side, known) << 26U | (wide ? 1U << 31U : 0U);
}
/// The bits of that word in which what is known of sides stands.
inline constexpr std::uint32_t list_side_bits = 31U << 26U;

/// The list that a cube names; without triangles where it is not there whole.
[[nodiscard]] inline TriangleList list_of(const DistanceOctree& octree,
                                          const std::uint32_t* unit) noexcept {
  TriangleList list;
  list.solids = unit[1] & max_listed_of_kind;
  list.sheets = unit[1] >> 13U & max_listed_of_kind;
  const std::uint32_t code = (unit[1] & list_side_bits) >> 26U;
  if (code < 3) {
    list.side = static_cast<ListSide>(code);
  } else {
    list.known = KnownPlace{(code - 3) / 2, code % 2 == 0};
  }
  list.wide = unit[1] >> 31U != 0;
  const std::size_t first = unit[0];
  if (first >= octree.lists.size()) return {};
  list.crossed = octree.lists[first] >> list_first_bits;
  if (list.word_count() > octree.lists.size() - first) return {};
  list.words = octree.lists.data() + first;
  return list;
}

}  // namespace spm
