// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <bit>
#include <cstddef>
#include <cstdint>
#include <span>

#include "common/base/octant.hpp"
#include "common/surface/support_plane.hpp"

namespace spm {

/// Kind of a cube of space around a `sparse` asset.
enum class SignKind : std::uint32_t {
  boundary = 0,  ///< the surface passes through: the nearest elements determine the side of a point
  inside = 1,    ///< wholly in the solid
  outside = 2,   ///< wholly outside the solid
  far = 3,       ///< wholly outside the solid, and beyond the margin
  pruned = 4,    ///< left out by the bake
  split = 7,     ///< split into eight cubes, each with its own kind
};

/// Sign octree over a cube of space, with two words per node:
///   0: the kinds of the eight octants, four bits each, octant k (bit 0: upper half in x, 1: y,
///      2: z) in bits 4 k to 4 k + 3;
///   1: the first of the nodes of its split octants, which are stored in the order of octants;
///      0 where none is split.
/// A child's number is greater than its parent's. Views; nothing is owned.
struct SignOctree {
  Vector3 origin = Vector3::Zero();  ///< lowest corner of the cube, m
  double edge = 0;                   ///< m
  std::span<const std::uint32_t> words;
};

inline constexpr std::size_t sign_octree_node_words = 2;
/// Largest number of halvings of the outer cube.
inline constexpr int sign_octree_levels = 20;
inline constexpr std::uint32_t sign_kind_bits = 4;

[[nodiscard]] constexpr SignKind octant_kind(std::uint32_t kinds, std::uint32_t octant) noexcept {
  return static_cast<SignKind>((kinds >> (sign_kind_bits * octant)) & 15U);
}

/// Number of split octants before this one.
[[nodiscard]] constexpr std::uint32_t splits_below(std::uint32_t kinds,
                                                   std::uint32_t octant) noexcept {
  const std::uint32_t split = kinds & (kinds >> 1U) & (kinds >> 2U) & 0x11111111U;
  return static_cast<std::uint32_t>(
      std::popcount(split & ((std::uint32_t{1} << (sign_kind_bits * octant)) - 1)));
}

/// The kind of the cube around a point; `far` outside the octree, and where the words are damaged.
[[nodiscard]] inline SignKind sign_at(const SignOctree& tree, const Vector3& point) noexcept {
  Vector3 within = (point - tree.origin) / tree.edge;
  if (!((within.array() >= 0).all() && (within.array() < 1).all())) return SignKind::far;
  std::size_t node = 0;
  for (int level = 0; level < sign_octree_levels; ++level) {
    if ((node + 1) * sign_octree_node_words > tree.words.size()) return SignKind::far;
    const std::uint32_t kinds = tree.words[node * sign_octree_node_words];
    const std::uint32_t octant = enter_octant(within);
    const SignKind kind = octant_kind(kinds, octant);
    if (kind != SignKind::split) return kind;
    node = std::size_t{tree.words[node * sign_octree_node_words + 1]} + splits_below(kinds, octant);
  }
  return SignKind::far;
}

[[nodiscard]] constexpr unsigned sign_bit(SignKind kind) noexcept {
  return 1U << static_cast<unsigned>(kind);
}

/// The kinds of all places in a cube, as a set of bits from sign_bit. Contains `far` where the
/// cube extends beyond the octree, or the words are damaged.
[[nodiscard]] unsigned signs_of_cube(const SignOctree& tree, const Vector3& middle,
                                     double half) noexcept;

}  // namespace spm
