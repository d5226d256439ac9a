// SPDX-License-Identifier: GPL-3.0-or-later
#include "tests/bench/reports/slide_paths.hpp"

#include <fmt/format.h>
#include <tbb/parallel_for.h>

#include <algorithm>
#include <cstddef>
#include <filesystem>
#include <fstream>

#include "baker/base/bake_error.hpp"
#include "formats/motion/trajectory.hpp"
#include "tests/bench/base/unwrap.hpp"
#include "tests/bench/model/places.hpp"
#include "tests/bench/model/query_sets.hpp"

namespace spm::bench {
namespace {

constexpr double on_surface = 1e-9;  // m; nearer the direction to the closest point is rounding

ExactTick exact_at(const Model& model, const Vector3& point) {
  const baker::SurfacePoint closest_point = model.truth.closest(point);
  const Vector3 away = point - closest_point.position;
  const double distance = away.norm();
  const double side = model.truth.inside(point) ? -1 : 1;
  ExactTick tick;
  tick.distance = side * distance;
  tick.outward = distance > on_surface ? Vector3(side * away / distance) : closest_point.normal;
  if (tick.distance < -model.band.max_depth || tick.distance > model.band.margin) return tick;
  tick.contested = model.truth.contested(point, closest_point, 2 * model.tolerance);
  return tick;
}

void add_truth(const Model& model, SlidePath& path) {
  path.ticks.resize(path.points.size());
  tbb::parallel_for(std::size_t{0}, path.points.size(),
                    [&](std::size_t i) { path.ticks[i] = exact_at(model, path.points[i]); });
}

/// One number a line; 0 is sliding. Empty where there is no such file.
std::vector<bool> read_phases(const std::string& trajectory, std::size_t count) {
  std::filesystem::path file(trajectory);
  file.replace_extension(".phase.txt");
  std::vector<bool> sliding;
  if (!std::filesystem::exists(file)) return sliding;
  std::ifstream stream(file);
  for (int phase = 0; sliding.size() < count && stream >> phase;) sliding.push_back(phase == 0);
  if (sliding.size() < count) {
    throw baker::BakeError(
        ExitCode::invalid_input,
        fmt::format("{}: line {}: no number; it must have one for each line of {}", file.string(),
                    sliding.size() + 1, trajectory));
  }
  return sliding;
}

}  // namespace

SlidePath recorded_slide(const Model& model, const std::string& file, std::size_t max_ticks) {
  const std::vector<TrajectorySample> samples = unwrap(read_trajectory(file));
  if (samples.empty()) {
    throw baker::BakeError(ExitCode::invalid_input, file + ": holds no position");
  }
  SlidePath path;
  path.name = "recorded";
  for (const TrajectorySample& sample : samples) {
    if (max_ticks > 0 && path.points.size() == max_ticks) break;
    path.points.push_back(sample.position);
  }
  add_truth(model, path);
  const std::vector<bool> sliding = read_phases(file, path.points.size());
  for (std::size_t i = 0; i < sliding.size(); ++i) path.ticks[i].sliding = sliding[i];
  return path;
}

SlidePath walked_slide(const Model& model, double depth, std::size_t ticks, std::uint64_t seed) {
  const WalkedPath walked = walk_surface(model, -depth, -depth, ticks, seed);
  SlidePath path;
  path.name = "walked";
  for (const TimedPlace& step : walked.steps) path.points.push_back(step.point);
  add_truth(model, path);
  for (std::size_t i = 0; i < walked.steps.size(); ++i) path.ticks[i].fresh = walked.steps[i].fresh;
  return path;
}

}  // namespace spm::bench
