// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <bit>
#include <cstddef>
#include <cstdint>
#include <optional>
#include <span>

#include "common/base/vector.hpp"

namespace spm {

/// What is known of a cube of the distance octree. Two top bits of the four: how many words the
/// cube takes.
enum class OctreeKind : std::uint32_t {
  far = 0,     ///< outside, beyond the margin
  pruned = 1,  ///< left out by the bake
  deep = 4,    ///< one word: inside, deeper than the band; the direction outwards
  map = 5,     ///< one word: a distance map, or two of which the smaller or larger one counts
  split = 8,   ///< two words: its octants
  list = 9,    ///< two words: a list of triangles
};

/// The distance octree of a `sparse` asset: all that its answers come from, with the indexed
/// triangles. Space is divided into cubes of one size (roots), x fastest; each of these into
/// octants, and so on. Views; nothing is owned.
///
/// A root's word: bits 0-3 its kind, bits 4-31 the place of its first word; of a `far` root the
/// distance of the surface from its middle instead, in clearance_unit, rounded down.
/// Words of a split cube: the place of the first word of its octants, which lie one behind the
///   other; the octants' kinds, four bits each, octant 0 (octant.hpp) lowest.
/// Words of a list: its place in `lists`; how many triangles and of which kind (TriangleList).
/// Word of a map: NamedMaps.
/// Word of a deep cube: the direction outwards, octahedral (octahedral.hpp).
///
/// Words may be anything, in a file that was damaged after it was checked, so each place is checked
/// before it is read.
struct DistanceOctree {
  Vector3 origin = Vector3::Zero();  ///< lowest corner
  double edge = 1;                   ///< of a root, m
  double per_edge = 1;               ///< 1 / edge; kept, since a division takes long
  std::array<std::uint32_t, 3> roots{0, 0, 0};
  std::span<const std::uint32_t> root_words;
  std::span<const std::uint32_t> words;
  std::span<const std::uint32_t> lists;
  double clearance_unit = 1;  ///< m
  double reach = 1;           ///< m
  /// Of what a leaf tells beyond the band's margin, the part by which the surface is farther than
  /// the margin at the least, to the tolerance; from 0, where nothing is promised, to 1.
  double beyond_share = 0;
};

inline constexpr int max_octree_levels = 12;

/// The most distance maps that words can name.
inline constexpr std::uint32_t max_named_maps = (1U << 15U) - 1;

/// How the distances of two maps make one.
struct MapPair {
  bool larger = false;  ///< the larger one counts, not the smaller
  bool edge = false;    ///< where the edge of both surfaces is what is nearest, its distance does
};

/// What the word of a map says: bits 0-14 the number of a chart (HeightChart), bits 16-30 that of a
/// second one plus 1, or 0; bits 31 and 15 how they make one distance (MapPair: larger, edge).
struct NamedMaps {
  std::uint32_t first = 0;
  std::uint32_t second_from_one = 0;  ///< 0: there is no second one
  MapPair pair;

  explicit constexpr NamedMaps(std::uint32_t word) noexcept
      : first(word & max_named_maps),
        second_from_one(word >> 16U & max_named_maps),
        pair{word >> 31U != 0, (word >> 15U & 1U) != 0} {}
  [[nodiscard]] constexpr bool two() const noexcept { return second_from_one != 0; }
  [[nodiscard]] constexpr std::uint32_t second() const noexcept { return second_from_one - 1; }
};

/// The word of one map, or of two.
[[nodiscard]] constexpr std::uint32_t word_of_map(std::uint32_t map) noexcept { return map; }
[[nodiscard]] constexpr std::uint32_t word_of_maps(std::uint32_t first, std::uint32_t second,
                                                   MapPair pair) noexcept {
  return first | (second + 1) << 16U | (pair.larger ? 1U << 31U : 0U) |
         (pair.edge ? 1U << 15U : 0U);
}

/// Whether a cube's places may have exact answers.
[[nodiscard]] constexpr bool has_answers(OctreeKind kind) noexcept {
  return kind == OctreeKind::map || kind == OctreeKind::list;
}

enum class ListSide : std::uint32_t { surface, outside, inside };

[[nodiscard]] constexpr std::uint32_t words_of(OctreeKind kind) noexcept {
  return static_cast<std::uint32_t>(kind) >> 2U;
}

/// The number of words of the octants before one, from the word of all kinds.
[[nodiscard]] constexpr std::uint32_t words_before(std::uint32_t kinds,
                                                   std::uint32_t octant) noexcept {
  std::uint32_t sizes = (kinds >> 2U) & 0x33333333U;
  sizes &= (1U << 4U * octant) - 1U;
  const std::uint32_t pairs = (sizes & 0x0F0F0F0FU) + ((sizes >> 4U) & 0x0F0F0F0FU);
  return (pairs * 0x01010101U) >> 24U;
}

/// What a root's word tells.
struct OctreeRoot {
  OctreeKind kind = OctreeKind::far;
  std::uint32_t word = 0;  ///< place of its first; of a `far` root the distance at its middle
};

[[nodiscard]] constexpr OctreeRoot unpack_root(std::uint32_t word) noexcept {
  return {static_cast<OctreeKind>(word & 15U), word >> 4U};
}

/// The root of a number, x fastest; none where there is no such root.
[[nodiscard]] inline std::optional<OctreeRoot> root_at(const DistanceOctree& octree,
                                                       std::uint64_t number) noexcept {
  if (number >= octree.root_words.size()) return {};
  return unpack_root(octree.root_words[number]);
}

/// A cube that is not divided.
struct Leaf {
  OctreeKind kind = OctreeKind::far;
  std::uint32_t word = 0;  ///< place of its first; of a `far` root the distance at its middle
  int level = -1;          ///< 0 a root; -1 outside all roots
  Vector3 middle = Vector3::Zero();
  double half = 0;  ///< of its edge, m
};

/// 2^exponent, by its bits; of small exponents.
[[nodiscard]] constexpr double power_of_two(int exponent) noexcept {
  return std::bit_cast<double>(static_cast<std::uint64_t>(1023 + exponent) << 52U);
}

/// Which leaf is around a point, as the descent to it finds it.
struct FoundLeaf {
  OctreeKind kind = OctreeKind::far;
  std::uint32_t word = 0;  ///< as Leaf's
  int level = -1;          ///< as Leaf's
  /// The point from the octree's origin, in steps of the smallest cubes that there may be.
  std::uint64_t step_x = 0, step_y = 0, step_z = 0;
};

/// The leaf around a point; `far` where there is none, or where the point is not a number.
// In single numbers throughout: vectors that are put together from them and read as a whole would
// wait for memory, for longer than all the rest takes.
[[nodiscard]] inline FoundLeaf find_leaf(const DistanceOctree& octree,
                                         const Vector3& point) noexcept {
  const double x = (point[0] - octree.origin[0]) * octree.per_edge;
  const double y = (point[1] - octree.origin[1]) * octree.per_edge;
  const double z = (point[2] - octree.origin[2]) * octree.per_edge;
  if (!(x >= 0 && y >= 0 && z >= 0 && x < octree.roots[0] && y < octree.roots[1] &&
        z < octree.roots[2])) {
    return {};
  }
  constexpr double steps = 1U << static_cast<unsigned>(max_octree_levels);
  FoundLeaf found;
  found.step_x = static_cast<std::uint64_t>(static_cast<std::int64_t>(x * steps));
  found.step_y = static_cast<std::uint64_t>(static_cast<std::int64_t>(y * steps));
  found.step_z = static_cast<std::uint64_t>(static_cast<std::int64_t>(z * steps));
  const std::uint64_t place =
      (found.step_x >> max_octree_levels) +
      octree.roots[0] * ((found.step_y >> max_octree_levels) +
                         std::uint64_t{octree.roots[1]} * (found.step_z >> max_octree_levels));
  const std::optional<OctreeRoot> root = root_at(octree, place);
  if (!root) return {};
  auto [kind, word] = *root;
  int level = 0;
  while (kind == OctreeKind::split) {
    if (level == max_octree_levels || std::size_t{word} + 1 >= octree.words.size()) return {};
    ++level;
    const auto bit = static_cast<unsigned>(max_octree_levels - level);
    const auto octant =
        static_cast<std::uint32_t>((found.step_x >> bit & 1U) | (found.step_y >> bit & 1U) << 1U |
                                   (found.step_z >> bit & 1U) << 2U);
    const std::uint32_t* words = octree.words.data() + word;
    kind = static_cast<OctreeKind>((words[1] >> 4U * octant) & 15U);
    word = words[0] + words_before(words[1], octant);
  }
  found.kind = kind;
  found.word = word;
  found.level = level;
  return found;
}

/// The cube of a found leaf.
[[nodiscard]] inline Leaf leaf_of(const DistanceOctree& octree, const FoundLeaf& found) noexcept {
  if (found.level < 0) return {};
  const auto coarse = static_cast<unsigned>(max_octree_levels - found.level);
  const double edge = octree.edge * power_of_two(-found.level);
  Leaf leaf;
  leaf.kind = found.kind;
  leaf.word = found.word;
  leaf.level = found.level;
  leaf.half = edge / 2;
  leaf.middle[0] = octree.origin[0] + edge * (static_cast<double>(found.step_x >> coarse) + 0.5);
  leaf.middle[1] = octree.origin[1] + edge * (static_cast<double>(found.step_y >> coarse) + 0.5);
  leaf.middle[2] = octree.origin[2] + edge * (static_cast<double>(found.step_z >> coarse) + 0.5);
  return leaf;
}

/// find_leaf and leaf_of.
[[nodiscard]] inline Leaf leaf_at(const DistanceOctree& octree, const Vector3& point) noexcept {
  return leaf_of(octree, find_leaf(octree, point));
}

/// A leaf's words, or null where they are not there.
[[nodiscard]] inline const std::uint32_t* words_at(const DistanceOctree& octree, OctreeKind kind,
                                                   std::uint32_t word) noexcept {
  return std::size_t{word} + words_of(kind) <= octree.words.size() ? octree.words.data() + word
                                                                   : nullptr;
}
[[nodiscard]] inline const std::uint32_t* words_at(const DistanceOctree& octree,
                                                   const Leaf& leaf) noexcept {
  return words_at(octree, leaf.kind, leaf.word);
}

/// Starts to load the words of a leaf.
inline void prefetch(const DistanceOctree& octree, const Leaf& leaf) noexcept {
  if (const std::uint32_t* words = words_at(octree, leaf)) __builtin_prefetch(words);
}

}  // namespace spm
