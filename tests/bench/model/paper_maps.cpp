// SPDX-License-Identifier: GPL-3.0-or-later
#include "tests/bench/model/paper_maps.hpp"

#include <fmt/format.h>

#include <utility>

#include "baker/full/full.hpp"
#include "baker/planes/hull.hpp"
#include "baker/planes/planes.hpp"
#include "tests/bench/model/model.hpp"

namespace spm::bench {

PaperMaps::PaperMaps(const baker::Mesh& mesh, const baker::Caster& caster,
                     std::optional<std::size_t> planes, std::uint32_t resolution)
    : asset_(std::make_unique<Asset>()) {
  const Clock::time_point start = Clock::now();
  baker::BakeOptions options;
  options.form = AssetForm::full;
  options.planes = planes;
  options.resolution = resolution;
  options.layers = baker::Layers::scalar;
  const baker::Hull hull = baker::convex_hull(mesh.vertices);
  asset_->metadata.form = AssetForm::full;
  asset_->metadata.diagonal = mesh.diagonal;
  asset_->metadata.band = bench_band;
  asset_->planes = baker::make_support_planes(hull, options.kind, options.planes).planes;
  baker::CastCounts counts;
  asset_->maps = baker::cast_full_maps(caster, asset_->planes, options, {}, counts);
  tables_ = tables_of(*asset_);
  seconds_ = seconds_since(start);
}

std::uint64_t PaperMaps::bytes() const noexcept {
  constexpr std::size_t plane = 4 * sizeof(double) + sizeof(SupportPlane) + sizeof(DistanceMap);
  std::uint64_t total = plane * asset_->planes.size();
  for (const MapData& map : asset_->maps) total += map.samples.size() * sizeof(float);
  return total;
}

std::string PaperMaps::settings() const {
  const std::uint32_t samples = asset_->maps.empty() ? 0 : asset_->maps.front().columns;
  return fmt::format("{} planes, {}x{}", asset_->planes.size(), samples, samples);
}

}  // namespace spm::bench
