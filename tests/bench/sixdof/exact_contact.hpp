// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <Eigen/Geometry>

#include "common/base/wrench.hpp"
#include "tests/bench/sixdof/sixdof_scene.hpp"

namespace spm::bench {

/// Force and torque (about the tool's origin) on a tool at a pose from the overlap of the exact
/// meshes: the integral, over the part of the tool's outer surface that is inside the object, of
/// `stiffness` (N/m3) times depth and direction to the object's nearest surface. Triangles are
/// split until their places are within `radius` (m) of their middles. Nothing that was baked is
/// used.
[[nodiscard]] Wrench exact_wrench(const BakedObject& tool, const BakedObject& object,
                                  const Eigen::Isometry3d& tool_pose, double stiffness,
                                  double radius);

}  // namespace spm::bench
