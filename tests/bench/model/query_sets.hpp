// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <cstdint>

#include "tests/bench/base/timing.hpp"
#include "tests/bench/model/places.hpp"

namespace spm::bench {

/// A hand's path in the band: what is timed, and what is true at each step.
struct WalkedPath {
  std::vector<TimedPlace> steps;
  Places places;  ///< one a step
};

/// Walks over the surface in steps of at most 0.1 mm while the signed distance swings between two
/// heights, metres, within the band; starts anew, with a fresh step, where the band or the surface
/// ends. Deterministic. Throws BakeError where no step can be made.
[[nodiscard]] WalkedPath walk_surface(const Model& model, double low, double high,
                                      std::size_t steps, std::uint64_t seed);

/// The first `count` of the places that errors are measured at, all fresh.
[[nodiscard]] std::vector<TimedPlace> random_places(const Model& model, const Places& places,
                                                    std::size_t count);

}  // namespace spm::bench
