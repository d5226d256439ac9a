// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

#include "baker/mesh/mesh.hpp"
#include "baker/surface/self_intersection.hpp"

namespace spm::baker {

/// Triangles cut along each other so that two pieces meet only along their edges. This holds up to
/// the rounding of new points to doubles.
struct SplitMesh {
  std::vector<Vector3> points;         ///< the mesh's own first
  std::vector<Triangle> pieces;        ///< oriented as the triangles they come from
  std::vector<std::uint32_t> parents;  ///< the triangle that each piece comes from, ascending
  Counted split;                       ///< triangles that became more than one piece
  /// Pairs that overlap in a common plane, both ways round and sorted.
  std::vector<TrianglePair> coplanar;
  std::vector<TrianglePair> facing;  ///< those that face each other, both ways round and sorted
};

/// Cuts triangles along their intersections with exact constructions, and those that face each
/// other along each other's outlines, as seen along their normals; sequential and deterministic.
/// Pieces that have no area after rounding are left out.
[[nodiscard]] SplitMesh split_triangles(std::span<const Vector3> points,
                                        std::span<const Triangle> triangles,
                                        const MeetingPairs& pairs);

}  // namespace spm::baker
