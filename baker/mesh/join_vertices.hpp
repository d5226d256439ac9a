// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <cstdint>
#include <vector>

#include "baker/mesh/mesh.hpp"

namespace spm::baker {

/// For each vertex the one that stands for it: the first that stands for itself within `distance`
/// (m, above 0).
[[nodiscard]] std::vector<std::uint32_t> join_vertices(const std::vector<Vector3>& vertices,
                                                       double distance);

}  // namespace spm::baker
