// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <array>
#include <vector>

#include "common/base/vector.hpp"

namespace spm::baker {

/// Triangles around a shared corner: triangle k has the corners 0, k + 1 and k + 2.
using TriangleFan = std::vector<Vector3>;

/// Joins triangles into fans, to need fewer corners. Triangles that share a corner and an edge and
/// are wound alike are joined, the longest fans first. Corners are shared where they are equal.
/// Each triangle is in exactly one fan.
[[nodiscard]] std::vector<TriangleFan> fans_of(
    const std::vector<std::array<Vector3, 3>>& triangles);

}  // namespace spm::baker
