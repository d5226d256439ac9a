// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <cstddef>
#include <span>
#include <vector>

#include "baker/mesh/mesh.hpp"

namespace spm::baker {

/// Turns outward what bounds a part from outside, and drops what only lies between its cells, as
/// between the tetrahedra of a volume mesh; returns how many triangles were dropped, with a corner
/// of one. Only of parts that more than two triangles at an edge divide into cells, and that are no
/// closed surfaces which touch. Which way their triangles face in the file does not matter. Parts
/// whose triangles lie on one another, or have no area, stay as they are.
Counted drop_inner_faces(std::span<const Vector3> points, std::vector<Triangle>& triangles);

}  // namespace spm::baker
