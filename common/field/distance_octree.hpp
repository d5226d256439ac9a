// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <bit>
#include <cstddef>
#include <cstdint>
#include <span>

#include "common/base/vector.hpp"

namespace spm {

/// What is known of a cube of the distance octree. Two top bits of the four: how many units of two
/// words the cube takes (units_of).
enum class OctreeKind : std::uint32_t {
  far = 0,         ///< outside, beyond the margin
  pruned = 1,      ///< left out by the bake
  deep = 4,        ///< inside, deeper than the band; one unit: the direction outwards
  split = 5,       ///< one unit: its octants
  list = 6,        ///< one unit: a list of triangle clusters
  polynomial = 8,  ///< two units: a local map
  least = 12,      ///< four units: two local maps, the smaller distance counts
  most = 13,       ///< four units: two local maps, the larger distance counts
};

/// The distance octree of a `sparse` asset: all that its answers come from, with the clusters of
/// triangles. Space is divided into cubes of one size (roots), x fastest; each of these into
/// octants, and so on. Views; nothing is owned.
///
/// A root's word: bits 0-3 its kind, bits 4-31 its first unit; of a `far` root the distance of the
/// surface and the caps from its middle instead, in clearance_unit, rounded down.
/// Units of a split cube: word 0 is the first unit of its octants, which lie one behind the other;
///   word 1 has the octants' kinds, four bits each, octant 0 (octant.hpp) lowest.
/// Units of a list: word 0 is the list's place in `lists`; word 1: bits 0-11 its clusters, bits
///   12-23 how many of these, the last ones, are caps, bits 24-25 the side (ListSide).
/// A list is one word for each cluster: bits 0-23 the cluster; bits 24-31 how far it is at least
/// from
///   every point of the cube, in 1/255 of `reach`, ascending within triangles and within caps.
/// Unit of a deep cube: word 0 is the direction outwards, octahedral (octahedral.hpp).
///
/// Words may be anything, in a file that was damaged after it was checked, so each place is checked
/// before it is read.
struct DistanceOctree {
  Vector3 origin = Vector3::Zero();  ///< lowest corner
  double edge = 1;                   ///< of a root, m
  std::array<std::uint32_t, 3> roots{0, 0, 0};
  std::span<const std::uint32_t> root_words;
  std::span<const std::uint32_t> units;
  std::span<const std::uint32_t> lists;
  double value_unit = 1;      ///< m: of a packed local map's value, times half the cube's edge
  double clearance_unit = 1;  ///< m
  double reach = 1;           ///< m
};

inline constexpr int max_octree_levels = 12;

enum class ListSide : std::uint32_t { surface, outside, inside };

[[nodiscard]] constexpr std::uint32_t units_of(OctreeKind kind) noexcept {
  const std::uint32_t size = static_cast<std::uint32_t>(kind) >> 2U;
  return size + (size == 3 ? 1U : 0U);
}

/// The number of units of the octants before one, from the word of all kinds.
[[nodiscard]] constexpr std::uint32_t units_before(std::uint32_t kinds,
                                                   std::uint32_t octant) noexcept {
  std::uint32_t sizes = (kinds >> 2U) & 0x33333333U;
  sizes += sizes & (sizes >> 1U) & 0x11111111U;
  sizes &= (octant == 0 ? 0U : 0xFFFFFFFFU >> (32U - 4U * octant));
  const std::uint32_t pairs = (sizes & 0x0F0F0F0FU) + ((sizes >> 4U) & 0x0F0F0F0FU);
  return (pairs * 0x01010101U) >> 24U;
}

/// A cube that is not divided.
struct Leaf {
  OctreeKind kind = OctreeKind::far;
  std::uint32_t unit = 0;  ///< its first; of a `far` root the distance at its middle
  int level = -1;          ///< 0 a root; -1 outside all roots
  Vector3 middle = Vector3::Zero();
  double half = 0;      ///< of its edge, m
  double per_half = 0;  ///< 1 / half; kept, since a division takes longer than all of a polynomial
};

/// The leaf around a point; `far` where there is none, or where the point is not a number.
[[nodiscard]] inline Leaf leaf_at(const DistanceOctree& octree, const Vector3& point) noexcept {
  Leaf leaf;
  const double per_edge = 1 / octree.edge;
  const Vector3 at = (point - octree.origin) * per_edge;
  for (int axis = 0; axis < 3; ++axis) {
    if (!(at[axis] >= 0 && at[axis] < octree.roots[static_cast<std::size_t>(axis)])) return leaf;
  }
  const std::array<std::uint32_t, 3> root{static_cast<std::uint32_t>(at[0]),
                                          static_cast<std::uint32_t>(at[1]),
                                          static_cast<std::uint32_t>(at[2])};
  const std::size_t place =
      root[0] + octree.roots[0] * (root[1] + std::size_t{octree.roots[1]} * root[2]);
  if (place >= octree.root_words.size()) return leaf;
  const std::uint32_t word = octree.root_words[place];
  leaf.kind = static_cast<OctreeKind>(word & 15U);
  leaf.unit = word >> 4U;
  leaf.level = 0;
  constexpr double steps = 1U << static_cast<unsigned>(max_octree_levels);
  const std::array<std::uint32_t, 3> within{static_cast<std::uint32_t>((at[0] - root[0]) * steps),
                                            static_cast<std::uint32_t>((at[1] - root[1]) * steps),
                                            static_cast<std::uint32_t>((at[2] - root[2]) * steps)};
  while (leaf.kind == OctreeKind::split) {
    if (leaf.level == max_octree_levels || 2 * std::size_t{leaf.unit} + 1 >= octree.units.size()) {
      return {};
    }
    ++leaf.level;
    const auto bit = static_cast<unsigned>(max_octree_levels - leaf.level);
    const std::uint32_t octant = ((within[0] >> bit) & 1U) | ((within[1] >> bit) & 1U) << 1U |
                                 ((within[2] >> bit) & 1U) << 2U;
    const std::uint32_t first = octree.units[2 * std::size_t{leaf.unit}];
    const std::uint32_t kinds = octree.units[2 * std::size_t{leaf.unit} + 1];
    leaf.kind = static_cast<OctreeKind>((kinds >> (4U * octant)) & 15U);
    leaf.unit = first + units_before(kinds, octant);
  }
  const auto coarse = static_cast<unsigned>(max_octree_levels - leaf.level);
  // By its bits, 2^level.
  const auto divided =
      std::bit_cast<double>(std::uint64_t{1023U + static_cast<unsigned>(leaf.level)} << 52U);
  leaf.per_half = 2 * per_edge * divided;
  const double edge =
      octree.edge *
      std::bit_cast<double>(std::uint64_t{1023U - static_cast<unsigned>(leaf.level)} << 52U);
  leaf.half = edge / 2;
  for (int axis = 0; axis < 3; ++axis) {
    const auto k = static_cast<std::size_t>(axis);
    leaf.middle[axis] =
        octree.origin[axis] + octree.edge * root[k] + edge * ((within[k] >> coarse) + 0.5);
  }
  return leaf;
}

/// The words of a leaf's units, or null where they are not there.
[[nodiscard]] inline const std::uint32_t* units_at(const DistanceOctree& octree,
                                                   const Leaf& leaf) noexcept {
  const std::size_t first = 2 * std::size_t{leaf.unit};
  return first + 2 * std::size_t{units_of(leaf.kind)} <= octree.units.size()
             ? octree.units.data() + first
             : nullptr;
}

/// Starts to load the words of a leaf.
inline void prefetch(const DistanceOctree& octree, const Leaf& leaf) noexcept {
  if (const std::uint32_t* words = units_at(octree, leaf)) __builtin_prefetch(words);
}

}  // namespace spm
