// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <cstdint>
#include <span>
#include <utility>
#include <vector>

#include "baker/mesh/mesh.hpp"

namespace spm::baker {

using TrianglePair = std::pair<std::uint32_t, std::uint32_t>;

/// Pairs of triangles, first below second, sorted, that have more in common than the corner or edge
/// they share. Exact predicates.
[[nodiscard]] std::vector<TrianglePair> intersecting_pairs(std::span<const Vector3> points,
                                                           std::span<const Triangle> triangles);

}  // namespace spm::baker
