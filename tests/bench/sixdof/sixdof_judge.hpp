// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <Eigen/Geometry>
#include <cstddef>
#include <cstdint>
#include <string>
#include <vector>

#include "common/sixdof/contact_sum.hpp"
#include "tests/bench/sixdof/sixdof.hpp"
#include "tests/bench/sixdof/sixdof_scene.hpp"

namespace spm::bench {

/// A path that methods follow, with what their answers are compared with at some of its ticks.
struct JudgedPath {
  std::string name;  ///< as of SixdofRow
  std::vector<Eigen::Isometry3d> poses;
  std::vector<std::size_t> ticks;  ///< that are judged: those of them that touch
  std::vector<Wrench> exact;       ///< there, by the overlap of the exact meshes
};

/// Finds the exact forces at `judged` of the ticks that the peers compute. `stiffness` in
/// N/m3. On all cores.
[[nodiscard]] JudgedPath judged_path(std::string name, std::vector<Eigen::Isometry3d> poses,
                                     const SixdofPlan& plan, std::uint64_t judged,
                                     const BakedObject& tool, const BakedObject& object,
                                     double stiffness);

/// What every sample of the finest level pushes with at the judged ticks. On all cores.
[[nodiscard]] std::vector<Wrench> finest_level(const JudgedPath& path, const SurfaceSamples& tool,
                                               const AssetView& object, double stiffness);

/// How far wrenches are from what is wanted, at the same ticks. `any_size`: what is wanted is first
/// made as large as the force that was found.
struct WrenchErrors {
  TickQuantiles force, torque;  ///< relative
  TickQuantiles direction;      ///< rad, of the force
};
[[nodiscard]] WrenchErrors wrench_errors(const std::vector<Wrench>& found,
                                         const std::vector<Wrench>& wanted, bool any_size);

/// Of the values in order, the one below which that share lies; 0 of none.
[[nodiscard]] double quantile_of_ticks(std::vector<double>& values, double share);

}  // namespace spm::bench
