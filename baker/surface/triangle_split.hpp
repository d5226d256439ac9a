// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <span>
#include <utility>
#include <vector>

#include "baker/mesh/mesh.hpp"
#include "baker/mesh/triangle_fan.hpp"
#include "baker/surface/self_intersection.hpp"

namespace spm::baker {

/// Triangles cut into pieces, which are oriented as the triangles they come from. Where triangles
/// lie on each other there is one piece for all, which faces as most of them do.
struct SplitMesh {
  std::vector<Vector3> points;  ///< the mesh's own first
  std::vector<Triangle> pieces;
  std::vector<std::uint32_t>
      parents;                        ///< the triangle of each, or the first cut with it; ascending
  std::vector<std::uint32_t> jumps;   ///< by how much the winding number is more behind each
  std::vector<std::uint32_t> planes;  ///< by triangle, the first of those it was cut with
  Counted split;                      ///< triangles that became more than one piece
  std::vector<ExactKernel::Point_3> added;  ///< the points after the mesh's, before rounding

  /// A point before rounding.
  [[nodiscard]] ExactKernel::Point_3 exact_place(std::uint32_t point) const;
};

/// Cuts triangles along their intersections with exact constructions, sequential and deterministic:
/// two pieces of solids, the first `solids` triangles, meet only along whole edges, before
/// rounding, which may leave pieces without area. Solids that lie on each other in one plane are
/// cut together, along their outlines. Sheets cut no others; their pieces come last.
[[nodiscard]] SplitMesh split_triangles(std::span<const Vector3> points,
                                        std::span<const Triangle> triangles,
                                        std::span<const TrianglePair> crossing, std::size_t solids);

/// A triangle, and a segment along which it is cut, as seen along its normal.
using SeenCut = std::pair<std::uint32_t, std::array<Vector3, 2>>;

/// Cuts triangles along segments that lie over them. Pieces without area are left out.
[[nodiscard]] SplitMesh cut_as_seen(std::span<const Vector3> points,
                                    std::span<const Triangle> triangles,
                                    std::span<const SeenCut> cuts);

}  // namespace spm::baker
