// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "tests/bench/model/model.hpp"
#include "tests/bench/reports/force_errors.hpp"

namespace spm::bench {

/// The path of a probe at 1 kHz, and the ground truth at each tick.
struct SlidePath {
  std::string name;  ///< recorded or walked
  std::vector<Vector3> points;
  std::vector<ExactTick> ticks;
};

/// A recorded trajectory, cut after `max_ticks` if that is above 0. The file beside it that ends in
/// `.phase.txt` instead of `.txt`, if it exists, marks the sliding ticks (a line with 0: sliding).
/// Throws BakeError if either file cannot be read.
[[nodiscard]] SlidePath recorded_slide(const Model& model, const std::string& file,
                                       std::size_t max_ticks);

/// Speed of walk_surface at 1 kHz.
inline constexpr double walked_speed = 0.1;  // m/s

/// A point that slides at walked_speed, `depth` metres below the surface; see walk_surface. Throws
/// BakeError.
[[nodiscard]] SlidePath walked_slide(const Model& model, double depth, std::size_t ticks,
                                     std::uint64_t seed);

}  // namespace spm::bench
