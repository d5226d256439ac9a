// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "tests/bench/base/timing.hpp"
#include "tests/bench/methods/methods.hpp"
#include "tests/bench/reports/bytes.hpp"

namespace spm::bench {

/// What `spm-bench methods` measures.
struct TimesPlan {
  std::vector<ModelSource> models;
  std::vector<double> tolerances;           ///< m: for `spm`, besides each model's own
  std::vector<double> adaptive_tolerances;  ///< m: of `adaptive-sdf` and `hp-sdf`
  std::vector<double> voxels;               ///< m: of `dense-sdf`, `openvdb` and `nanovdb`
  std::vector<NanoVoxel> nano_voxels;       ///< of `nanovdb`
  std::vector<double> grid_cells;           ///< m: of `triangle-grid`
  std::size_t paper_planes = 1000;
  std::uint32_t paper_resolution = 65;
  double probe_radius = 0.5e-3;      ///< m: of the probe rows
  std::vector<std::string> methods;  ///< only these; all where empty
  std::string bakes;                 ///< folder of assets, see BakeFolder; temporary where empty
  std::uint64_t samples = 100000;
  std::size_t path_steps = 4096;
  std::uint64_t seed = 1;
  unsigned threads = 0;  ///< for builds and scores; timing uses one
  bool scalar = true;    ///< also times the product without SIMD
  TimingPlan timing;
};

/// A method with one setting on one model.
struct TimesRow {
  std::string model;
  MethodFacts facts;
  QueryTimes ns;
  Score score;
  bool on_path = false;  ///< judged along the path, as it has state; else at the places
};

/// A ball against the surface.
struct ProbeRow {
  std::string model;
  std::string method, settings;
  double hot = 0;           ///< ns
  double p50 = 0, p99 = 0;  ///< m, errors of the depth along the path
  double missed = 0;        ///< share of true contacts that are not found
};

struct TimesReport {
  std::vector<ModelRow> models;
  std::vector<TimesRow> rows;
  std::vector<ProbeRow> probe_rows;
  std::vector<FailureRow> failures;
};

/// The names of the methods, in the order of the table.
[[nodiscard]] const std::vector<std::string>& timed_method_names();

/// Loads each model, builds every method, scores them with all threads, and times them against each
/// other on one core. A method that cannot be built is a failure of its row. Throws BakeError if a
/// model cannot be measured at all.
[[nodiscard]] TimesReport measure_times(const TimesPlan& plan, const BenchProgress& progress);

/// The row of `spm`, point by point, at the model's own tolerance; null where there is none.
[[nodiscard]] const TimesRow* own_row(const TimesReport& report, const ModelRow& model);

}  // namespace spm::bench
