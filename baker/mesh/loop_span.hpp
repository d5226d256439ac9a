// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "baker/mesh/mesh.hpp"

namespace spm::baker {

/// Vertices one after the other, the last of which leads to the first.
using Loop = std::vector<std::uint32_t>;

/// Adds triangles that span a loop, of the least area in all and with the loop's sense. In time by
/// the third power of the corners; of loops of more than 400 the smallest corners are cut off
/// first.
void span_loop(std::span<const Vector3> points, Loop loop, std::vector<Triangle>& triangles);

}  // namespace spm::baker
