// SPDX-License-Identifier: GPL-3.0-or-later
#include "baker/full/full.hpp"

#include <tbb/parallel_for.h>

#include <algorithm>
#include <atomic>
#include <cmath>

#include "baker/base/progress_counter.hpp"

namespace spm::baker {

namespace {

/// A cell of a map is valid where its bilinear patch meets the ray at its middle within this share
/// of the diagonal.
constexpr double continuity_share = 2.5e-4;
/// Steeper cells see the surface at too flat an angle to answer for it.
constexpr double largest_slope = 2.5;
/// Crossings kept along a ray; a candidate names its layer in eight bits.
constexpr std::size_t max_layers = 255;

/// Rows of rays of one plane: its samples, and the middles of its cells.
struct Rays {
  std::uint32_t columns = 0;
  std::vector<Column> samples;
  std::vector<Column> middles;
};

/// Places the map's rectangle over the plane's own region and moves x0 to its first sample.
/// Returns the spacing.
double place_map(std::vector<SupportPlane>& planes, std::size_t which, const Rectangle& region,
                 std::uint32_t resolution, double diagonal) {
  SupportPlane& plane = planes[which];
  const double width = std::max(region.eta_max - region.eta_min, 0.0);
  const double height = std::max(region.omega_max - region.omega_min, 0.0);
  const bool empty = region.eta_max < region.eta_min || region.omega_max < region.omega_min;
  const double middle_eta = empty ? 0 : (region.eta_min + region.eta_max) / 2;
  const double middle_omega = empty ? 0 : (region.omega_min + region.omega_max) / 2;
  // A ring of samples around the region, where there are samples to spare, for the border's slopes.
  const double inner = resolution >= 9 ? resolution - 3.0 : resolution - 1.0;
  const double extent = std::max({width, height, 1e-6 * diagonal});
  const double spacing = extent / inner;
  const double half = spacing * (resolution - 1.0) / 2;
  plane.x0 = support_plane_point(plane, middle_eta - half, middle_omega - half);
  return spacing;
}

/// Puts a ray's crossings into layer slots: entries into even slots, exits into odd slots, with a
/// gap where one is missing. The first slot always holds the first hit, as in the paper's scalar
/// map.
void slots_of(const Column& column, std::size_t limit, std::vector<float>& slots) {
  slots.clear();
  for (const Crossing& crossing : column.crossings) {
    const bool wants_entry = slots.size() % 2 == 0;
    if (crossing.entry != wants_entry && !slots.empty()) slots.push_back(no_hit);
    slots.push_back(static_cast<float>(crossing.depth));
  }
  if (slots.size() > limit) slots.resize(limit);
}

/// True where the bilinear patch of a cell's layer follows the surface, as measured at the middle
/// ray.
bool follows_surface(const MapData& map, std::uint32_t layer, std::uint32_t column,
                     std::uint32_t row, const Column& middle, double allowed) {
  const std::size_t first =
      (static_cast<std::size_t>(layer) * map.rows + row) * map.columns + column;
  const double h00 = map.samples[first];
  const double h10 = map.samples[first + 1];
  const double h01 = map.samples[first + map.columns];
  const double h11 = map.samples[first + map.columns + 1];
  const double low = std::min({h00, h10, h01, h11});
  const double high = std::max({h00, h10, h01, h11});
  if (!std::isfinite(high) || high - low > largest_slope * map.spacing) return false;
  const double patch = (h00 + h10 + h01 + h11) / 4;
  return std::any_of(
      middle.crossings.begin(), middle.crossings.end(), [&](const Crossing& crossing) {
        return crossing.entry == (layer % 2 == 0) && std::abs(crossing.depth - patch) <= allowed;
      });
}

void fill_mask(MapData& map, const Rays& rays, double allowed) {
  map.mask.assign(mask_words(map.columns, map.rows, map.layers), 0);
  std::uint32_t bit = 0;
  for (std::uint32_t layer = 0; layer < map.layers; ++layer) {
    for (std::uint32_t row = 0; row + 1 < map.rows; ++row) {
      for (std::uint32_t column = 0; column + 1 < map.columns; ++column, ++bit) {
        const std::size_t first = static_cast<std::size_t>(row) * map.columns + column;
        const bool consistent = rays.samples[first].consistent &&
                                rays.samples[first + 1].consistent &&
                                rays.samples[first + map.columns].consistent &&
                                rays.samples[first + map.columns + 1].consistent;
        const Column& middle =
            rays.middles[static_cast<std::size_t>(row) * (map.columns - 1) + column];
        if (consistent && follows_surface(map, layer, column, row, middle, allowed)) {
          map.mask[bit >> 5U] |= 1U << (bit & 31U);
        }
      }
    }
  }
}

std::size_t layer_limit(const BakeOptions& options) {
  switch (options.layers) {
    case Layers::scalar:
      return 1;
    case Layers::limited:
      return std::min<std::size_t>(options.layer_limit, max_layers);
    case Layers::automatic:
      break;
  }
  return max_layers;
}

void cast_rays(const Caster& caster, const SupportPlane& plane, const MapData& map, Rays& rays) {
  rays.samples.resize(static_cast<std::size_t>(map.columns) * map.rows);
  rays.middles.resize(static_cast<std::size_t>(map.columns - 1) * (map.rows - 1));
  for (std::uint32_t row = 0; row < map.rows; ++row) {
    for (std::uint32_t column = 0; column < map.columns; ++column) {
      caster.cast(plane, column * map.spacing, row * map.spacing,
                  rays.samples[static_cast<std::size_t>(row) * map.columns + column]);
      if (column + 1 == map.columns || row + 1 == map.rows) continue;
      caster.cast(plane, (column + 0.5) * map.spacing, (row + 0.5) * map.spacing,
                  rays.middles[static_cast<std::size_t>(row) * (map.columns - 1) + column]);
    }
  }
}

/// Casts one plane's map: eq. 2 for every sample.
MapData cast_map(const Caster& caster, const SupportPlane& plane, std::uint32_t which,
                 double spacing, const BakeOptions& options, CastCounts& counts) {
  MapData map;
  map.plane = which;
  map.columns = map.rows = options.resolution;
  map.spacing = spacing;
  Rays rays;
  cast_rays(caster, plane, map, rays);
  std::vector<std::vector<float>> slots(rays.samples.size());
  const std::size_t limit = layer_limit(options);
  std::size_t layers = 1;
  for (std::size_t i = 0; i < slots.size(); ++i) {
    slots_of(rays.samples[i], limit, slots[i]);
    layers = std::max(layers, slots[i].size());
    counts.inconsistent += rays.samples[i].consistent ? 0 : 1;
    counts.layers_max =
        std::max(counts.layers_max, static_cast<std::uint32_t>(rays.samples[i].crossings.size()));
  }
  counts.rays += rays.samples.size();
  map.layers = static_cast<std::uint32_t>(layers);
  map.samples.assign(layers * slots.size(), no_hit);
  for (std::size_t i = 0; i < slots.size(); ++i) {
    for (std::size_t layer = 0; layer < slots[i].size(); ++layer) {
      map.samples[layer * slots.size() + i] = slots[i][layer];
    }
  }
  fill_mask(map, rays, continuity_share * caster.diagonal());
  return map;
}

}  // namespace

std::vector<MapData> cast_full_maps(const Caster& caster, std::vector<SupportPlane>& planes,
                                    const BakeOptions& options, const Progress& progress,
                                    CastCounts& counts) {
  std::vector<MapData> maps(planes.size());
  std::vector<CastCounts> each(planes.size());
  std::vector<double> spacing(planes.size());
  std::vector<SupportPlane> placed = planes;
  ProgressCounter counter(progress, "casting", planes.size());
  tbb::parallel_for(std::size_t{0}, planes.size(), [&](std::size_t i) {
    spacing[i] = place_map(placed, i, own_region(planes, i), options.resolution, caster.diagonal());
    maps[i] =
        cast_map(caster, placed[i], static_cast<std::uint32_t>(i), spacing[i], options, each[i]);
    counter.done();
  });
  planes = std::move(placed);
  for (const CastCounts& one : each) {
    counts.rays += one.rays;
    counts.inconsistent += one.inconsistent;
    counts.layers_max = std::max(counts.layers_max, one.layers_max);
  }
  return maps;
}

}  // namespace spm::baker
