// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "tests/bench/base/bench_progress.hpp"
#include "tests/bench/sixdof/culling.hpp"

namespace spm::bench {

/// What `spm-bench sixdof` measures.
struct SixdofPlan {
  std::string tool, object;      ///< mesh files
  double tool_tolerance = 5e-5;  ///< m
  double tolerance = 5e-5;       ///< m, of the object
  std::vector<std::uint64_t> samples;
  std::uint64_t ticks = 5000;      ///< of the path, at 1 kHz
  std::uint64_t peer_ticks = 500;  ///< of them, evenly, that peers are asked
  std::uint64_t judged = 100;      ///< of them, evenly, that forces are judged at
  std::uint64_t reference_samples = 130000;
  std::uint64_t culled_objects = 1000;  ///< of the largest scene of culling
  std::uint64_t seed = 1;
};

struct TickQuantiles {
  double median = 0, p95 = 0;
};

/// A method with one setting, along the path.
struct SixdofRow {
  std::string method;
  std::string settings;
  std::uint64_t samples = 0;  ///< of the tool; 0 for meshes
  /// s a tick, by the clock on the wall: of the passes over the path the median, most and mean of
  /// all.
  double p50 = 0, p99 = 0, max = 0, mean = 0;
  double busy_p99 = 0;  ///< s a tick of the core's time alone, likewise
  double tested = 0;    ///< samples whose distance was read, mean a tick
  double asked = 0;     ///< queries of the baked field, mean a tick
  double contacts = 0;  ///< mean a tick
  double level = 0;     ///< mean of those that were resolved, 1 the finest
  double degraded = 0;  ///< share of the ticks that ended before the finest
  /// Of the force, of that of the reference; none where the method has another law.
  std::optional<TickQuantiles> force_error;
  TickQuantiles direction_error;  ///< rad
};

struct SixdofReport {
  std::string tool, object;
  std::uint64_t tool_triangles = 0, object_triangles = 0;
  std::uint64_t ticks = 0, judged = 0, reference_samples = 0;
  std::vector<SixdofRow> rows;
  std::uint64_t hull_points = 0;  ///< of the tool's, which the scenes of culling are made of
  std::vector<CullingRow> culling;
};

/// Bakes both meshes, makes the path, then lets one method after another follow it on one core.
/// Throws BakeError.
[[nodiscard]] SixdofReport measure_sixdof(const SixdofPlan& plan, const BenchProgress& progress);

}  // namespace spm::bench
