// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <cstddef>

#include "baker/base/progress.hpp"
#include "baker/mesh/mesh.hpp"
#include "baker/smooth/smooth_options.hpp"

namespace spm::baker {

/// Fills in the options that depend on the size of the object: the sigma of a crease operator.
/// Throws BakeError usage where sigma is more than a tenth or less than a ten-thousandth of the
/// diagonal, m.
[[nodiscard]] SmoothOptions fitted_to(SmoothOptions options, double diagonal);

/// The outer surface of a mesh, smoothed, as a mesh that takes the object's place in what follows.
///
/// First, edges near bends are halved until none is longer than half a sigma. Then each vertex goes
/// to the mean of the surface around it, weighted by the kernel of eq. 16 over the distance along
/// the surface. So the map of every support plane that sees the place is filtered together with the
/// closest points of its distances, in one pass from the unsmoothed surface. Flat places and border
/// vertices stay. With `crease` so do the vertices of edges that turn by more than its angle, and
/// windows end there as well. Vertices never leave the convex hull. The result is the same for any
/// number of threads. Throws BakeError usage as `fitted_to`, and where it would take more than 2
/// million triangles or too many neighbours.
[[nodiscard]] Mesh smoothed_mesh(const Mesh& mesh, const SmoothOptions& options,
                                 const Progress& progress, SmoothReport& report);

}  // namespace spm::baker
