// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <cstdint>
#include <span>
#include <utility>
#include <vector>

#include "baker/mesh/mesh.hpp"

namespace spm::baker {

using TrianglePair = std::pair<std::uint32_t, std::uint32_t>;

/// Pairs of triangles that have more in common than the corner or edge that they share. The first
/// of a pair is below the second, and pairs are sorted. Exact predicates.
[[nodiscard]] std::vector<TrianglePair> intersecting_pairs(std::span<const Vector3> points,
                                                           std::span<const Triangle> triangles);

}  // namespace spm::baker
