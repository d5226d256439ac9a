// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "tests/bench/methods/tick_timing.hpp"
#include "tests/bench/reports/bytes.hpp"

namespace spm::bench {

/// The figures that the paper reports for one process, us.
struct PaperFigure {
  double mean = 0, sd = 0;
};

/// A model that the paper measured, and its recorded slide.
struct SlidSource {
  int table = 2;
  ModelSource model;
  std::string trajectory;  ///< path of the file
  std::size_t planes = 1000;
  PaperFigure mesh_based, free_form;
};

/// What `spm-bench tables` measures.
struct TablesPlan {
  std::vector<SlidSource> slides;         ///< Tables 2 and 3
  std::vector<int> subdivisions;          ///< Table 1: bumpy spheres of 20 * 4^n triangles
  std::vector<std::size_t> plane_counts;  ///< Table 1: support planes on the coarsest of them
  std::size_t paper_planes = 1000;        ///< in the other rows of Table 1
  std::uint32_t paper_resolution = 65;
  double scaling_tolerance = 100e-6;  ///< m: for `spm` in Table 1
  double probe_radius = 0.5e-3;       ///< m: of the rows with a ball
  std::size_t slide_steps = 1000;     ///< Table 1's path
  std::size_t max_ticks = 0;          ///< of the recorded slides; 0: all
  unsigned threads = 0;               ///< for the bakes; timing uses one
  TickPlan timing;
};

/// One figure of a table.
struct TableRow {
  int table = 0;
  std::string model;
  std::uint64_t triangles = 0;
  std::string process;  ///< as the paper calls it: mesh-based, free-form; or ours
  std::string method, settings;
  std::uint64_t planes = 0;  ///< of the paper's method, else 0
  bool with_collision_detection = true;
  TickTimes us;
  std::uint64_t bytes = 0;
  std::optional<PaperFigure> paper;
};

/// How a method's time grows: as n to the power `exponent`, over Table 1's rows.
struct GrowthRow {
  std::string method, settings;
  bool with_collision_detection = true;
  std::string over;  ///< triangles or planes
  double exponent = 0;
};

struct TablesReport {
  std::vector<TableRow> rows;
  std::vector<GrowthRow> growth;
  std::vector<FailureRow> failures;
};

/// Bakes, then times force after force along the slides. A bake that fails is a failure of its row.
/// Throws BakeError where a mesh or a trajectory cannot be read.
[[nodiscard]] TablesReport measure_tables(const TablesPlan& plan, const BenchProgress& progress);

/// Least-squares slopes in log-log scale, for the methods that Table 1 has at several counts.
[[nodiscard]] std::vector<GrowthRow> growth_of(const std::vector<TableRow>& rows);

}  // namespace spm::bench
