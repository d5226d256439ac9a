// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <vector>

#include "baker/mesh/mesh.hpp"

namespace spm::bench {

/// A sphere with bumps. The shape is the same at any number of triangles: 20 * 4^subdivisions,
/// without an upper limit. Metres; the diagonal of the bounding box is about 0.1 m.
[[nodiscard]] baker::Mesh bumpy_sphere(int subdivisions);

/// A spiral over it, `depth` metres below its surface, in steps of 40 um (40 mm/s at 1 kHz), after
/// a descent from outside. Distances are measured along the radius.
[[nodiscard]] std::vector<Vector3> bumpy_slide(std::size_t steps, double depth);

}  // namespace spm::bench
