// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <cstddef>
#include <span>
#include <vector>

#include "baker/mesh/mesh.hpp"
#include "baker/mesh/sliver_removal.hpp"
#include "baker/surface/self_intersection.hpp"
#include "baker/surface/solid_side.hpp"

namespace spm::baker {

/// What is left of a surface, and what is not: its pieces, m2.
struct Felt {
  std::vector<LooseTriangle> triangles;
  std::size_t hidden = 0;
  double hidden_area = 0;
};

/// Takes away what of the boundary of solids bounds gaps that are too narrow to count, where
/// triangles face each other within `narrow`, m, and what of sheets lies in solids, on them or in
/// such gaps. `triangles` are pieces of the mesh's and have the first of those that theirs was cut
/// with in its plane for a parent, by `planes`; cuts add `points`. `solids`: by
/// their boundary, as it was. What is left is cut no more than needed.
[[nodiscard]] Felt without_narrow_gaps(const Mesh& mesh, std::span<const TrianglePair> facing,
                                       std::span<const std::uint32_t> planes, double narrow,
                                       const SolidSide& solids, std::vector<Vector3>& points,
                                       const std::vector<LooseTriangle>& triangles);

}  // namespace spm::baker
