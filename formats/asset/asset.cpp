// SPDX-License-Identifier: Apache-2.0
#include "formats/asset/asset.hpp"

#include <algorithm>
#include <cmath>
#include <utility>

#include "formats/asset/chart_words.hpp"

namespace spm {
namespace {

Vector3 round_to_step(const Vector3& value, double steps_per_unit) {
  return value.unaryExpr([steps_per_unit](double x) {
    // Adding zero turns -0 into 0, which prints shorter.
    return std::round(x * steps_per_unit) / steps_per_unit + 0.0;
  });
}

/// Decimal steps per metre such that a step is at most 1e-8 of the diagonal, which is the precision
/// of the unit vectors beside it.
double steps_per_metre(double diagonal) {
  const double digits = diagonal > 0 && std::isfinite(diagonal)
                            ? std::clamp(8 - std::floor(std::log10(diagonal)), 0.0, 15.0)
                            : 9.0;
  return std::pow(10.0, digits);
}

}  // namespace

AssetTables::AssetTables(std::vector<SupportPlane> planes, std::vector<DistanceMap> maps,
                         std::vector<std::vector<std::uint32_t>> layer_offsets,
                         std::vector<HeightChart> charts, const AssetView& rest)
    : planes_(std::move(planes)),
      maps_(std::move(maps)),
      charts_(std::move(charts)),
      layer_offsets_(std::move(layer_offsets)),
      view_(rest) {
  if (rest.full) {
    for (const SupportPlane& plane : planes_) {
      nx_.push_back(plane.n.x());
      ny_.push_back(plane.n.y());
      nz_.push_back(plane.n.z());
      offset_.push_back(plane.n.dot(plane.x0));
    }
  }
  view_.planes = planes_;
  view_.maps = maps_;
  view_.charts = charts_;
  view_.plane_nx = nx_;
  view_.plane_ny = ny_;
  view_.plane_nz = nz_;
  view_.plane_offset = offset_;
}

std::uint64_t AssetTables::bytes() const noexcept {
  const auto of = [](const auto& table) {
    return static_cast<std::uint64_t>(table.capacity()) * sizeof(table[0]);
  };
  std::uint64_t bytes = of(planes_) + of(maps_) + of(charts_) + of(layer_offsets_) + of(nx_) +
                        of(ny_) + of(nz_) + of(offset_);
  for (const auto& offsets : layer_offsets_) bytes += of(offsets);
  return bytes;
}

AssetTables tables_of(const Asset& asset) {
  // All maps of one shape share a table: in memory layers lie one behind the other.
  std::uint32_t layers = 0;
  for (const MapData& map : asset.maps) layers = std::max(layers, map.layers);
  std::vector<std::vector<std::uint32_t>> offsets(1);
  if (!asset.maps.empty()) {
    const std::uint32_t layer_size = asset.maps.front().columns * asset.maps.front().rows;
    for (std::uint32_t layer = 0; layer < layers; ++layer) offsets[0].push_back(layer * layer_size);
  }
  std::vector<DistanceMap> maps;
  maps.reserve(asset.maps.size());
  for (const MapData& map : asset.maps) {
    maps.push_back({.samples = map.samples.data(),
                    .layer_offsets = offsets[0].data(),
                    .mask = map.mask.data(),
                    .plane = map.plane,
                    .columns = map.columns,
                    .rows = map.rows,
                    .layers = map.layers,
                    .row_stride = map.columns,
                    .eta0 = map.eta0,
                    .omega0 = map.omega0,
                    .spacing = map.spacing});
  }
  AssetView rest;
  rest.triangles = asset.triangles;
  rest.grid = {.origin = asset.grid.origin,
               .cell_size = asset.grid.cell_size,
               .cells = asset.grid.cells,
               .index = asset.grid.index,
               .records = asset.grid.records};
  asset.octree.add_to(rest);
  asset.metadata.add_to(rest);
  rest.atlas = std::span(asset.atlas.heights);
  std::vector<HeightChart> charts;
  charts.reserve(asset.atlas.charts.size());
  for (const ChartData& chart : asset.atlas.charts) {
    charts.push_back(chart_over(chart, asset.planes[chart.plane], asset.atlas, rest.atlas));
  }
  return AssetTables(asset.planes, std::move(maps), std::move(offsets), std::move(charts), rest);
}

void AssetMetadata::add_to(AssetView& view) const noexcept {
  view.band = band;
  view.box_low = box_min - Vector3::Constant(sheet_thickness);
  view.box_high = box_max + Vector3::Constant(sheet_thickness);
  view.tolerance = answer_tolerance(*this);
  view.sheet_thickness = sheet_thickness;
  view.full = form == AssetForm::full;
}

void round_planes(std::vector<SupportPlane>& planes, double diagonal) {
  constexpr double unit_steps = 1e8;
  const double metre_steps = steps_per_metre(diagonal);
  for (SupportPlane& plane : planes) {
    plane.x0 = round_to_step(plane.x0, metre_steps);
    plane.u = round_to_step(plane.u, unit_steps);
    plane.v = round_to_step(plane.v, unit_steps);
    plane.n = round_to_step(plane.n, unit_steps);
  }
}

void round_to_stored(Asset& asset) {
  if (asset.metadata.form == AssetForm::full) return;
  round_planes(asset.planes, asset.metadata.diagonal);
}

}  // namespace spm
