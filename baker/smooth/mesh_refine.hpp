// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <cstddef>
#include <functional>

#include "baker/smooth/surface_mesh.hpp"

namespace spm::baker {

/// Says whether the surroundings of an edge must be refined.
using EdgeChoice = std::function<bool(const MeshEdge&)>;

/// Halves the edges longer than `longest` metres that are within `distance` metres of a chosen
/// edge, until there are none. Vertices keep their places and indices. Where the surface is flat,
/// edges may be laid anew. Throws BakeError usage where that takes more than `max_triangles`
/// triangles.
[[nodiscard]] SurfaceMesh refined(SurfaceMesh surface_mesh, const EdgeChoice& choice,
                                  double longest, double distance, std::size_t max_triangles);

}  // namespace spm::baker
