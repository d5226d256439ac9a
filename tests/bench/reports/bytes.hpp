// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "tests/bench/base/bench_progress.hpp"
#include "tests/bench/methods/method.hpp"
#include "tests/bench/methods/score.hpp"
#include "tests/bench/model/model.hpp"
#include "tests/bench/reports/size_at_error.hpp"

namespace spm::bench {

/// What `spm-bench bytes` measures.
struct BytesPlan {
  std::vector<ModelSource> models;
  std::vector<double> tolerances;    ///< m: `spm`, `adaptive-sdf`; besides each model's own
  std::vector<double> voxels;        ///< m: of `dense-sdf`, `openvdb` and `nanovdb`
  std::vector<double> grid_cells;    ///< m: of `triangle-grid`
  std::vector<std::string> methods;  ///< only these; all where empty
  std::string bakes;                 ///< folder of assets, see BakeFolder; temporary where empty
  std::uint64_t samples = 100000;
  std::uint64_t seed = 1;
  unsigned threads = 0;  ///< 0: as many as there are cores; changes no figure but seconds
};

/// A measured model.
struct ModelRow {
  std::string name;
  double tolerance = 0;  ///< m
  std::uint64_t triangles = 0, vertices = 0;
  std::uint64_t samples = 0;
  double contested = 0;  ///< share of the samples without a direction to judge
};

/// A method with one setting on one model.
struct MethodRow {
  std::string model;
  MethodFacts facts;
  Score score;
};

/// How many bytes of memory a method needs for the 99 % error that `spm` has at the model's
/// tolerance. Files are compared by the rows.
struct ComparisonRow {
  std::string model;
  std::string method;
  double error = 0;  ///< m
  std::uint64_t spm_bytes = 0;
  std::optional<SizeAtError> size;
};

/// A method that could not be built, and why.
struct FailureRow {
  std::string model;
  std::string method;
  std::string reason;
};

struct BytesReport {
  std::vector<ModelRow> models;
  std::vector<MethodRow> rows;
  std::vector<ComparisonRow> comparisons;
  std::vector<FailureRow> failures;
};

/// The names of the methods, in the order of the table.
[[nodiscard]] const std::vector<std::string>& method_names();

/// Loads each model, draws its places, then builds, queries and drops the methods in turn. A bake
/// that fails is a failure of its row. Throws BakeError where a model cannot be measured at all.
[[nodiscard]] BytesReport measure_bytes(const BytesPlan& plan, const BenchProgress& progress);

/// One row per method and model, at the error that `spm` reached with the model's own tolerance.
[[nodiscard]] std::vector<ComparisonRow> compare_bytes(const std::vector<ModelRow>& models,
                                                       const std::vector<MethodRow>& rows);

}  // namespace spm::bench
