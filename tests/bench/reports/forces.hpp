// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "tests/bench/reports/bytes.hpp"
#include "tests/bench/reports/force_errors.hpp"
#include "tests/bench/reports/slide_paths.hpp"

namespace spm::bench {

/// A model to slide on.
struct ForceSource {
  ModelSource model;
  std::string trajectory;  ///< file of the recorded trajectory; none if empty
  std::size_t planes = 1000;
};

/// What `spm-bench forces` measures.
struct ForcesPlan {
  std::vector<ForceSource> sources;
  std::uint32_t paper_resolution = 65;
  double stiffness = 1e3;        ///< N/m
  double probe_radius = 0.5e-3;  ///< m: for the row with a ball
  double turn_rate = 120;        ///< rad/s: for the `spm` row with a turn limit
  double depth = 1e-3;           ///< m: of the walked slide
  std::size_t walked_ticks = 20000;
  std::size_t max_ticks = 0;  ///< limit for the recorded slides; 0: all
  std::uint64_t seed = 1;
  unsigned threads = 0;  ///< 0: as many as there are cores; changes no figure
};

/// One path on one model, for one probe size, with the results of the exact penalty.
struct PathRow {
  std::string model, path;
  double radius = 0;  ///< m
  std::uint64_t ticks = 0;
  JudgedTicks judged;
  Quantiles exact_step;           ///< N, while sliding
  std::uint64_t exact_rough = 0;  ///< number of these ticks with a step of at least smooth_step
};

/// One method on one path.
struct ForceRow {
  std::string model, path, method, settings;
  double radius = 0;     ///< m
  double turn_rate = 0;  ///< rad/s, 0: without a limit
  ForceErrors errors;
};

/// The forces of all methods on one path, tick by tick.
struct ForceTrace {
  struct Series {
    std::string method;
    double radius = 0;
    double turn_rate = 0;
    std::vector<Vector3> forces;  ///< N
  };
  std::string model;
  SlidePath path;
  std::vector<Series> series;
};

struct ForcesReport {
  std::vector<PathRow> paths;
  std::vector<ForceRow> rows;
  std::vector<ForceTrace> traces;
  std::vector<FailureRow> failures;
};

/// Bakes, then computes forces along the recorded slides and along walked ones. A bake that fails
/// is a failure of its rows. Throws BakeError where a mesh or a trajectory cannot be read.
[[nodiscard]] ForcesReport measure_forces(const ForcesPlan& plan, const BenchProgress& progress);

}  // namespace spm::bench
