// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <Eigen/Geometry>

#include "common/base/wrench.hpp"
#include "tests/bench/sixdof/sixdof_scene.hpp"

namespace spm::bench {

/// Force on a tool at a pose by the law of ObjectContact, from all samples of the finest level.
/// Depths and directions come from the object's exact surface. The baked field is used only to skip
/// samples that are farther outside than three tolerances.
[[nodiscard]] Wrench exact_wrench(const SurfaceSamples& tool, const BakedObject& object,
                                  const Eigen::Isometry3d& tool_pose, double stiffness);

}  // namespace spm::bench
