// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <cstddef>
#include <cstdint>
#include <span>
#include <utility>
#include <vector>

#include "baker/mesh/mesh.hpp"

namespace spm::baker {

using TrianglePair = std::pair<std::uint32_t, std::uint32_t>;

/// Pairs of triangles that meet. The first of a pair is below the second, and pairs are sorted.
struct MeetingPairs {
  /// They have more in common than the corner or edge that they share; by exact predicates.
  std::vector<TrianglePair> crossing;
  /// They face each other and cover each other in part, and one lies within a
  /// distance of the other's plane. A sheet faces both ways; two sheets are no such pair. Some of
  /// them cross as well.
  std::vector<TrianglePair> facing;
};
/// `near`, m: the distance of those that face each other; with 0 there are none. The first `solids`
/// of the triangles are of solids, the others of sheets.
[[nodiscard]] MeetingPairs meeting_pairs(std::span<const Vector3> points,
                                         std::span<const Triangle> triangles, double near,
                                         std::size_t solids = SIZE_MAX);

}  // namespace spm::baker
