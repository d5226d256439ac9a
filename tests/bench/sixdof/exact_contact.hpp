// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <Eigen/Geometry>

#include "tests/bench/sixdof/sixdof_scene.hpp"

namespace spm::bench {

/// Force on a tool at a pose by the law of ObjectContact, from all of its finest samples, whose
/// depths and directions are those of the object's exact surface. The baked field only tells which
/// samples need not be asked, being farther out than three tolerances.
[[nodiscard]] Vector3 exact_force(const SurfaceSamples& tool, const BakedObject& object,
                                  const Eigen::Isometry3d& tool_pose, double stiffness);

}  // namespace spm::bench
