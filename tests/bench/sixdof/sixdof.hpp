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
  std::uint64_t ticks = 5000;      ///< number on the path, at 1 kHz
  std::uint64_t peer_ticks = 500;  ///< how many of them, evenly spaced, the peers compute
  std::uint64_t judged = 250;      ///< how many of them, evenly spaced, have their force judged
  std::uint64_t judged_deep = 50;  ///< the same of the path on which much of the tool touches
  double reference_radius = 5e-5;  ///< m: how fine the overlap of the exact meshes is integrated
  std::uint64_t culled_objects = 1000;  ///< in the largest culling scene
  std::uint64_t seed = 1;
};

struct TickQuantiles {
  double median = 0, p95 = 0, p99 = 0;
};

/// A method with one setting, along the path.
struct SixdofRow {
  std::string path = "slide";  ///< or "deep": a third of the tool's samples touch
  std::string method;          ///< `served-...`: the servo's SceneForce
  std::string settings;
  std::uint64_t samples = 0;  ///< number on the tool; 0 for meshes
  /// Wall-clock time per tick, s. `p50` and `p99` are medians over the passes along the path; `max`
  /// and `mean` are over all passes.
  double p50 = 0, p99 = 0, max = 0, mean = 0;
  std::uint64_t bytes = 0;  ///< that answers come from beside the object's file; 0: not known
  double busy_p99 = 0;      ///< CPU time per tick, s; the median over the passes, as above
  double tested = 0;        ///< samples whose distance was read, mean per tick
  double asked = 0;         ///< queries of the baked field, mean per tick
  double contacts = 0;      ///< mean per tick
  double level = 0;         ///< mean sample level that was reached; 1 is the finest
  double degraded = 0;      ///< share of the ticks that ended before the finest level
  /// Relative to the size of the reference force; none if the method uses another force law.
  std::optional<TickQuantiles> force_error;
  /// The same of the torque about the tool's origin.
  std::optional<TickQuantiles> torque_error;
  /// The same against the sum over every sample of the tool's finest level.
  std::optional<TickQuantiles> finest_force_error, finest_torque_error;
  TickQuantiles direction_error;  ///< rad
};

struct SixdofReport {
  std::string tool, object;
  std::uint64_t tool_triangles = 0, object_triangles = 0;
  std::uint64_t ticks = 0, judged = 0, judged_deep = 0;
  double reference_radius = 0;  ///< m
  std::vector<SixdofRow> rows;
  CullingReport culling;
};

/// Bakes both meshes, makes the path, then lets one method after another follow it on one core.
/// Throws BakeError.
[[nodiscard]] SixdofReport measure_sixdof(const SixdofPlan& plan, const BenchProgress& progress);

}  // namespace spm::bench
