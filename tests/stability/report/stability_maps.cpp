// SPDX-License-Identifier: GPL-3.0-or-later
#include "tests/stability/report/stability_maps.hpp"

#include <tbb/parallel_for.h>

#include <algorithm>
#include <cmath>
#include <numbers>

#include "tests/stability/catalogue/catalogue.hpp"
#include "tests/stability/theory/sampled_loop.hpp"

namespace spm::stability {
namespace {

/// The catalogue's first case, held for a shorter time.
StabilityCase pressed_wall(const MapPlan& plan, double delay) {
  StabilityCase wall = wall_cases().front();
  const double cut = wall.hand.back().rest - plan.rest;
  wall.hand.back().rest -= cut;
  wall.seconds -= cut;
  wall.delay_ticks = delay;
  return wall;
}

/// The linear part of a device against a wall.
SampledLoop loop_of(const servo::SimProfile& profile, double damping, double delay) {
  SampledLoop loop;
  loop.mass = profile.mass;
  loop.device_damping = profile.damping + damping;
  loop.delay_ticks = delay;
  loop.lag = profile.bandwidth > 0 ? 1 / (2 * std::numbers::pi * profile.bandwidth) : 0;
  loop.hand = servo::HandModel::arm;
  return loop;
}

}  // namespace

double flat_theory(const servo::SimProfile& profile) {
  return border_stiffness(loop_of(profile, 0, wall_cases().front().delay_ticks));
}

StabilityMap measure_map(const MapPlan& plan, const Contender& contender,
                         const servo::SimProfile& profile, std::uint64_t seed) {
  StabilityMap map;
  map.method = name_of(contender);
  map.device = profile.name;
  map.dampings = plan.dampings;
  map.delays = plan.delays;
  const int last = std::max(1, plan.stiffnesses - 1);
  for (int i = 0; i < plan.stiffnesses; ++i) {
    map.stiffnesses.push_back(plan.min_stiffness * std::pow(plan.max_stiffness / plan.min_stiffness,
                                                            static_cast<double>(i) / last));
  }
  for (const double delay : map.delays) {
    for (const double damping : map.dampings) {
      map.theory.push_back(border_stiffness(loop_of(profile, damping, delay)));
    }
  }
  const std::size_t stiffnesses = map.stiffnesses.size();
  const std::size_t lines = map.delays.size() * map.dampings.size();
  map.stable.assign(lines * stiffnesses, 0);
  tbb::parallel_for(std::size_t{0}, lines, [&](std::size_t line) {
    const StabilityCase wall = pressed_wall(plan, map.delays[line / map.dampings.size()]);
    RunSettings settings;
    settings.profile = &profile;
    settings.damping = map.dampings[line % map.dampings.size()];
    settings.seed = seed;
    for (std::size_t i = 0; i < stiffnesses; ++i) {
      settings.stiffness = map.stiffnesses[i];
      const Verdict verdict = run_and_judge(wall, settings, contender).verdict;
      map.stable[line * stiffnesses + i] = verdict.good ? 1 : 0;
    }
  });
  return map;
}

}  // namespace spm::stability
