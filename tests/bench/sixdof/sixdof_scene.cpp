// SPDX-License-Identifier: GPL-3.0-or-later
#include "tests/bench/sixdof/sixdof_scene.hpp"

#include <cmath>
#include <filesystem>
#include <utility>

#include "baker/base/bake_error.hpp"
#include "baker/mesh/load.hpp"
#include "tests/bench/model/model.hpp"

namespace spm::bench {
namespace {

constexpr int count_trials = 6;
constexpr double count_share = 0.1;

baker::BakeResult bake_within(const baker::Mesh& mesh, double tolerance) {
  baker::BakeOptions options;
  options.tolerance = tolerance;
  options.max_depth = bench_band.max_depth;
  options.margin = bench_band.margin;
  return baker::bake(mesh, options);
}

}  // namespace

BakedObject::BakedObject(const std::string& path, double diagonal, double tolerance)
    : name(std::filesystem::path(path).stem().string()),
      mesh(baker::load_mesh(path, {1, diagonal})),
      surface(baker::outer_surface(mesh)),
      truth(mesh),
      baked(bake_within(mesh, tolerance)),
      tables(tables_of(baked.asset)) {}

SurfaceSamples samples_of_count(const AssetView& asset, std::uint64_t count) {
  // A closed surface of a size has no more than that of its box.
  const Extent extent = extent_of(asset);
  double spacing = extent.size.norm() / std::sqrt(static_cast<double>(count));
  SurfaceSamples samples;
  for (int trial = 0; trial < count_trials; ++trial) {
    auto made = sample_surface(asset, spacing);
    if (!made) throw baker::BakeError(made.error().code, made.error().message);
    samples = std::move(*made);
    const double times =
        static_cast<double>(samples.levels.back().count) / static_cast<double>(count);
    if (std::abs(times - 1) < count_share) break;
    spacing *= std::sqrt(times);
  }
  return samples;
}

}  // namespace spm::bench
