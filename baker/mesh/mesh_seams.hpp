// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <cstddef>
#include <vector>

#include "baker/mesh/mesh.hpp"

namespace spm::baker {

/// What was joined along the borders of a mesh.
struct Seams {
  Counted border_edges;  ///< that there were before
  Counted welded;        ///< vertices that became one with another
  Counted split;         ///< triangles that vertices of others on their edges divided
};

/// Joins what only rounding holds apart along borders: vertices of border edges within `distance`,
/// m, become one, and a border edge is led through the vertices of others that lie on it within
/// that. Nothing else moves.
Seams join_seams(const std::vector<Vector3>& points, double distance,
                 std::vector<Triangle>& triangles);

}  // namespace spm::baker
