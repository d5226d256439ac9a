// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <cstddef>
#include <cstdint>
#include <string>
#include <vector>

#include "tests/bench/reports/slide_paths.hpp"
#include "tests/stability/laboratory/contenders.hpp"

namespace spm::stability {

/// What a contender's forces cost and how true they are, on one walked slide over an object.
struct CostRow {
  std::string method;         ///< of the contender
  double relative_error = 0;  ///< RMS of the difference to the exact penalty over the exact RMS
  double median_error = 0;    ///< as relative_error, but the median instead of the RMS
  double lost_share = 0;      ///< of the ticks: off by more than the exact force's RMS
  double mean_us = 0;         ///< of a tick, on one core
  double p99_us = 0;
};

/// What a stabilizer adds to the force of a gentle press, where it has nothing to stabilize.
struct IdleRow {
  std::string method;  ///< of the contender with its stabilizer
  std::string device;
  double added_step_n = 0;  ///< N: largest growth of a tick's step of force
};

struct CostPlan {
  double stiffness = 1000;  ///< N/m
  double depth = 0.5e-3;    ///< m: of the slide
  std::size_t ticks = 4000;
  std::uint64_t seed = 1;
};

/// The case of the teeth, for a point probe whose reading has no encoder steps.
[[nodiscard]] StabilityCase slid_teeth();

/// A slide below a surface, at 0.1 m/s, that a tool held by the surface can follow. The walked
/// slide (bench::walked_slide) passes under edges from one face to the next, which no hand can do:
/// from there on it is another slide (`fresh`).
struct HeldSlide {
  bench::SlidePath path;
  /// For each fresh tick, a free place above the surface to come from, m; zero for the others.
  std::vector<Vector3> free_places;
};

/// Walks below a case's object. Throws BakeError where it cannot be prepared.
[[nodiscard]] HeldSlide held_slide(const StabilityCase& object, const CostPlan& plan);

/// Each part of the slide begins in free space: the tool is led in and rests, and neither is
/// counted. Errors do not depend on the machine; times do, and nothing else should run meanwhile.
/// Throws BakeError where the object cannot be prepared.
[[nodiscard]] std::vector<CostRow> measure_costs(const std::vector<Contender>& contenders,
                                                 const StabilityCase& object, const CostPlan& plan);

/// Speed of a gentle press, m/s.
inline constexpr double gentle_speed = 0.02;

/// Presses gently on the catalogue's flat wall without stabilizers. Then runs the contender, one of
/// the product's methods with stabilizers, on the recorded readings.
[[nodiscard]] IdleRow measure_idle(const Contender& contender, const servo::SimProfile& profile,
                                   double stiffness);

}  // namespace spm::stability
