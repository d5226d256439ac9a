// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <bit>
#include <cstddef>
#include <cstdint>
#include <span>

#include "common/surface/support_plane.hpp"

namespace spm {

/// Kind of a cube of space around a `sparse` asset.
enum class SpaceKind : std::uint32_t {
  told = 0,     ///< the surface passes through: the nearest elements determine the side of a point
  inside = 1,   ///< wholly in the solid
  outside = 2,  ///< wholly outside the solid
  far = 3,      ///< wholly outside the solid, and beyond the margin
  pruned = 4,   ///< left out by the bake
  split = 7,    ///< split into eight cubes, each with its own kind
};

/// Sign octree over a cube of space, with two words per node:
///   0: the kinds of the eight octants, four bits each, octant k (bit 0: upper half in x, 1: y,
///      2: z) in bits 4 k to 4 k + 3;
///   1: the first of the nodes of its split octants, which are stored in the order of octants;
///      0 where none is split.
/// A child's number is greater than its parent's. Views; nothing is owned.
struct SpaceTree {
  Vector3 origin = Vector3::Zero();  ///< lowest corner of the cube, m
  double edge = 0;                   ///< m
  std::span<const std::uint32_t> words;
};

inline constexpr std::size_t space_node_words = 2;
/// Largest number of halvings of the outer cube.
inline constexpr int space_levels = 20;
inline constexpr std::uint32_t space_kind_bits = 4;

[[nodiscard]] constexpr SpaceKind octant_kind(std::uint32_t kinds, std::uint32_t octant) noexcept {
  return static_cast<SpaceKind>((kinds >> (space_kind_bits * octant)) & 15U);
}

/// Number of split octants before this one.
[[nodiscard]] constexpr std::uint32_t splits_below(std::uint32_t kinds,
                                                   std::uint32_t octant) noexcept {
  const std::uint32_t split = kinds & (kinds >> 1U) & (kinds >> 2U) & 0x11111111U;
  return static_cast<std::uint32_t>(
      std::popcount(split & ((std::uint32_t{1} << (space_kind_bits * octant)) - 1)));
}

/// The kind of the cube around a point; `far` outside the octree, and where the words are damaged.
[[nodiscard]] inline SpaceKind space_at(const SpaceTree& tree, const Vector3& point) noexcept {
  Vector3 within = (point - tree.origin) / tree.edge;
  if (!((within.array() >= 0).all() && (within.array() < 1).all())) return SpaceKind::far;
  std::size_t node = 0;
  for (int level = 0; level < space_levels; ++level) {
    if ((node + 1) * space_node_words > tree.words.size()) return SpaceKind::far;
    const std::uint32_t kinds = tree.words[node * space_node_words];
    std::uint32_t octant = 0;
    for (int axis = 0; axis < 3; ++axis) {
      within[axis] *= 2;
      if (within[axis] < 1) continue;
      within[axis] -= 1;
      octant |= 1U << static_cast<unsigned>(axis);
    }
    const SpaceKind kind = octant_kind(kinds, octant);
    if (kind != SpaceKind::split) return kind;
    node = std::size_t{tree.words[node * space_node_words + 1]} + splits_below(kinds, octant);
  }
  return SpaceKind::far;
}

[[nodiscard]] constexpr unsigned space_bit(SpaceKind kind) noexcept {
  return 1U << static_cast<unsigned>(kind);
}

/// The kinds of all places in a cube, as a set of bits from space_bit. Contains `far` where the
/// cube extends beyond the octree, or the words are damaged.
[[nodiscard]] unsigned spaces_of_cube(const SpaceTree& tree, const Vector3& middle,
                                      double half) noexcept;

}  // namespace spm
