// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <vector>

#include "baker/cast/cast.hpp"
#include "baker/mesh/sliver_removal.hpp"

namespace spm::baker {

/// How much a surface may change.
struct CollapseRules {
  double displacement = 0;  ///< m: so far it may move at most
  double height = 0;        ///< m: no new triangle is thinner
  double min_cosine = 0;    ///< of the angle from a new triangle to the mean of those it replaces
};

/// Leaves out vertices where the surface then moves by little: each is drawn along a side to a
/// neighbour, again and again, those that move it least mostly first. What is closed stays closed;
/// caps, holes and non-manifold places stay as they are, and so do sheets that lie close to another
/// one or fold, so that no two are moved through each other. `caster` is over the same surface, but
/// for rounding. Gives for each triangle that is left how far it is at most, m, from the surface as
/// it was, and that from it. The same for any number of threads.
[[nodiscard]] std::vector<double> collapse_edges(const std::vector<Vector3>& vertices,
                                                 const Caster& caster, const CollapseRules& rules,
                                                 std::vector<LooseTriangle>& triangles);

}  // namespace spm::baker
