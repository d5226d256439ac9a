// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <cstddef>
#include <cstdint>
#include <string>
#include <vector>

#include "tests/stability/contenders.hpp"

namespace spm::stability {

/// What a contender's forces cost and how true they are, on one walked slide over a real object.
struct CostRow {
  std::string method;         ///< of the contender
  double relative_error = 0;  ///< RMS of the difference to the exact penalty over the exact RMS
  double mean_us = 0;         ///< of a tick, on one core
  double p99_us = 0;
};

/// What a cure adds to the force of a gentle press, where it has nothing to cure.
struct IdleRow {
  std::string method;  ///< of the contender with its cure
  std::string device;
  double added_step_n = 0;  ///< N: most that a tick's step of force grew
};

struct CostPlan {
  std::string mesh = "teeth.obj";  ///< of the catalogue's real objects
  double stiffness = 1000;         ///< N/m
  double depth = 0.5e-3;           ///< m: of the slide
  std::size_t ticks = 4000;
  std::uint64_t seed = 1;
};

/// Errors do not depend on the machine; times do, and nothing else should run meanwhile. Throws
/// BakeError where the mesh cannot be read.
[[nodiscard]] std::vector<CostRow> measure_costs(const std::vector<Contender>& contenders,
                                                 const CostPlan& plan);

/// m/s, of a gentle press.
inline constexpr double gentle_speed = 0.02;

/// Presses the catalogue's flat wall gently without cures, and asks the contender, one of the
/// product's methods with cures, along what was read then.
[[nodiscard]] IdleRow measure_idle(const Contender& contender, const servo::SimProfile& profile,
                                   double stiffness);

}  // namespace spm::stability
