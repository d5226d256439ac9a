// SPDX-License-Identifier: GPL-3.0-or-later
#include "baker/full/trials.hpp"

#include <algorithm>

#include "common/base/random.hpp"

namespace spm::baker {

namespace {

constexpr std::uint64_t points_per_border_cell = 6;
/// A `full` asset has many cells; a random part of them is enough.
constexpr std::uint64_t max_cells_looked_at = 1'000'000;
constexpr std::uint64_t border_stream = 0xB0DE;

double height_in(const Band& band, double share) {
  return -band.max_depth + (band.max_depth + band.margin) * share;
}

/// Valid cells beside one that is not, and those beside a valid one.
bool at_border(const DistanceMap& map, std::uint32_t layer, std::uint32_t column,
               std::uint32_t row) {
  bool some_valid = false;
  bool some_not = column == 0 || row == 0;
  for (std::uint32_t j = row == 0 ? 0 : row - 1; j <= row + 1; ++j) {
    for (std::uint32_t i = column == 0 ? 0 : column - 1; i <= column + 1; ++i) {
      const bool valid = i + 1 < map.columns && j + 1 < map.rows && map.cell_valid(layer, i, j);
      some_valid |= valid;
      some_not |= !valid;
    }
  }
  return some_valid && some_not;
}

}  // namespace

Trials::Trials(const AssetView& asset, const Caster& caster, std::uint64_t uniform, double nearby,
               std::uint64_t seed)
    : asset_(asset),
      caster_(caster),
      uniform_(caster.solid_count() > 0 ? uniform : 0),
      nearby_(nearby),
      seed_(seed) {
  double sum = 0;
  for (std::uint32_t i = 0; i < caster.solid_count(); ++i) {
    const Vector3& a = caster.corner(i, 0);
    sum += (caster.corner(i, 1) - a).cross(caster.corner(i, 2) - a).norm();
    areas_.push_back(sum);
  }
  collect_borders();
}

void Trials::collect_borders() {
  std::uint64_t cells = 0;
  for (const DistanceMap& map : asset_.maps) {
    cells += std::uint64_t{map.layers} * map.cells_per_layer();
  }
  const std::uint64_t stride = cells / max_cells_looked_at + 1;
  std::uint64_t number = 0;
  for (std::uint32_t which = 0; which < asset_.maps.size(); ++which) {
    const DistanceMap& map = asset_.maps[which];
    for (std::uint32_t layer = 0; layer < map.layers; ++layer) {
      for (std::uint32_t row = 0; row + 1 < map.rows; ++row) {
        for (std::uint32_t column = 0; column + 1 < map.columns; ++column, ++number) {
          if (stride > 1 && random_bits(seed_, number) % stride != 0) continue;
          if (at_border(map, layer, column, row)) borders_.push_back({which, layer, column, row});
        }
      }
    }
  }
}

std::uint64_t Trials::count() const { return uniform_ + borders_.size() * points_per_border_cell; }

Probe Trials::probe(std::uint64_t index) const {
  return index < uniform_ ? anywhere(index) : about_border(index - uniform_);
}

Probe Trials::about_border(std::uint64_t index) const {
  const BorderCell& border = borders_[index / points_per_border_cell];
  const DistanceMap& map = asset_.maps[border.map];
  const std::uint64_t stream = seed_ ^ border_stream;
  const MapCell cell{border.column, border.row, random_unit(stream, 3 * index),
                     random_unit(stream, 3 * index + 1), true};
  const Vector3 on_map = reconstructed_surface(
      asset_.planes[map.plane], map.eta0 + (border.column + cell.fx) * map.spacing,
      map.omega0 + (border.row + cell.fy) * map.spacing, height_at(map, border.layer, cell).value);
  // Beside a silhouette there may be no height from which to start.
  if (!on_map.allFinite()) return anywhere(index);
  const ClosestPoint surface = caster_.closest(on_map);
  const Vector3& normal = caster_.normal(surface.triangle);
  const double share = random_unit(stream, 3 * index + 2);
  const double height = index % 2 == 0 ? nearby_ * (2 * share - 1) : height_in(asset_.band, share);
  return {surface.closest_point + height * normal, normal, height};
}

Probe Trials::anywhere(std::uint64_t index) const {
  const double share = random_unit(seed_, 4 * index) * areas_.back();
  const auto place = std::upper_bound(areas_.begin(), areas_.end(), share) - areas_.begin();
  const auto triangle =
      static_cast<std::uint32_t>(std::min(static_cast<std::size_t>(place), areas_.size() - 1));
  double x = random_unit(seed_, 4 * index + 1);
  double y = random_unit(seed_, 4 * index + 2);
  if (x + y > 1) {
    x = 1 - x;
    y = 1 - y;
  }
  const double height = height_in(asset_.band, random_unit(seed_, 4 * index + 3));
  const Vector3& a = caster_.corner(triangle, 0);
  const Vector3 closest_point =
      a + x * (caster_.corner(triangle, 1) - a) + y * (caster_.corner(triangle, 2) - a);
  const Vector3& normal = caster_.normal(triangle);
  return {closest_point + height * normal, normal, height};
}

}  // namespace spm::baker
