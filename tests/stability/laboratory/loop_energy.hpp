// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <cstddef>
#include <cstdint>
#include <vector>

#include "tests/stability/laboratory/contestant.hpp"
#include "tests/stability/laboratory/laboratory.hpp"
#include "tests/stability/objects/prepared_object.hpp"

namespace spm::stability {

/// How closed paths are laid in an object's surface.
struct LoopPlan {
  std::size_t loops = 100;
  double length = 10e-3;      ///< m, of each
  double min_depth = 0.1e-3;  ///< m below the place of the surface that a loop is laid at; the
  double max_depth = 0.6e-3;  ///< loop lies between the two where the surface is flat
  double step = 2e-6;         ///< m, along the path: a jump of the force by 1 N is 1 uJ off
  double stiffness = 1000;    ///< N/m
  std::uint64_t seed = 1;
};

/// A closed path, and a free place to come from.
struct ClosedLoop {
  Vector3 from = Vector3::Zero();  ///< m
  std::vector<Vector3> points;     ///< m; the first is not repeated at the end
};

/// Closed paths about places of the exact surface. Circles in the tangent plane alternate with flat
/// ellipses across it, which press, slide, lift and slide back. They are for a probe of the case's
/// radius. There are fewer than asked for where the surface leaves no free places.
[[nodiscard]] std::vector<ClosedLoop> closed_loops(const StabilityCase& tried,
                                                   const LoopPlan& plan);

/// Work (J) that a force law does on a tool that is led once round a closed path, without dynamics,
/// by the trapezoid rule over its forces. The tool comes from the free place and first goes round
/// once uncounted, so that a law with memory has reached its cycle. A gain, above 0, is energy made
/// out of nothing.
[[nodiscard]] double loop_work(Contestant& contestant, const ClosedLoop& loop, double step);

/// The energy that a static field gains.
struct LoopEnergy {
  double largest_j = 0;   ///< J, the most of all loops, either way round
  double median_j = 0;    ///< J, of each loop's better way round
  std::size_t worst = 0;  ///< which loop of closed_loops
  std::size_t loops = 0;
};

/// Leads a tool round all loops of a plan on a case's object (its shape, bake and probe; the rest
/// does not matter). In parallel, with the same result whatever the threads. Throws BakeError.
[[nodiscard]] LoopEnergy loop_energy(const StabilityCase& tried, const Contender& contender,
                                     const LoopPlan& plan);

}  // namespace spm::stability
