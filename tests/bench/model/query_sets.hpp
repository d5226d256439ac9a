// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <cstdint>

#include "tests/bench/base/timing.hpp"
#include "tests/bench/model/places.hpp"

namespace spm::bench {

/// The path of a hand in the band: the points to time, and the ground truth at each step.
struct WalkedPath {
  std::vector<TimedPlace> steps;
  Places places;  ///< one per step
};

/// Walks over the surface in steps of at most 0.1 mm while the signed distance swings between two
/// heights, metres, within the band. It restarts with a fresh step where the band or the surface
/// ends. Deterministic. Throws BakeError where no step can be made.
[[nodiscard]] WalkedPath walk_surface(const Model& model, double low, double high,
                                      std::size_t steps, std::uint64_t seed);

/// The first `count` of the places at which errors are measured, all fresh.
[[nodiscard]] std::vector<TimedPlace> random_places(const Model& model, const Places& places,
                                                    std::size_t count);

}  // namespace spm::bench
