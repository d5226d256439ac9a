// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "tests/bench/model/model.hpp"
#include "tests/bench/reports/force_errors.hpp"

namespace spm::bench {

/// A probe's path at 1 kHz and what is true along it, tick by tick.
struct SlidePath {
  std::string name;  ///< recorded or walked
  std::vector<Vector3> points;
  std::vector<ExactTick> ticks;
};

/// A recorded trajectory, cut after `max_ticks` where that is above 0. Which ticks slide is told
/// by the file beside it that ends in `.phase.txt` for `.txt` (0 a line: sliding), where there is
/// one. Throws BakeError where either file cannot be read.
[[nodiscard]] SlidePath recorded_slide(const Model& model, const std::string& file,
                                       std::size_t max_ticks);

/// Of walk_surface, at 1 kHz.
inline constexpr double walked_speed = 0.1;  // m/s

/// A point slid at walked_speed, `depth` metres below the surface; see walk_surface. Throws
/// BakeError.
[[nodiscard]] SlidePath walked_slide(const Model& model, double depth, std::size_t ticks,
                                     std::uint64_t seed);

}  // namespace spm::bench
