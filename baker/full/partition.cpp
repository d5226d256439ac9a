// SPDX-License-Identifier: GPL-3.0-or-later
#include "baker/full/partition.hpp"

#include <tbb/parallel_for.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <map>
#include <memory>
#include <string>
#include <utility>

#include "baker/base/bake_error.hpp"
#include "baker/base/progress_counter.hpp"
#include "baker/full/cell_fit.hpp"
#include "common/base/octahedral.hpp"
#include "common/base/octant.hpp"
#include "common/surface/closest_on_triangle.hpp"

namespace spm::baker {

namespace {

constexpr double cells_per_diagonal = 64;
/// A grid of more cells than this would not be worth its index.
constexpr double max_cells = 1 << 26;
/// A header with all bits set belongs to a split cell.
constexpr std::size_t max_triangles = 0xFFFE;

/// One cell of the partition after it was decided and before the records are laid out. It is far,
/// deep, a record of maps or triangles, or split into octants (x fastest).
struct PartitionCell {
  CellKind kind = CellKind::far;
  Vector3 middle = Vector3::Zero();
  double edge = 0;
  std::uint32_t normal = 0;              ///< of a deep cell, octahedral
  std::vector<std::uint32_t> maps;       ///< candidate words
  std::vector<std::uint32_t> triangles;  ///< of the caster
  std::unique_ptr<std::array<PartitionCell, 8>> octants;
};

/// Below this many triangles a closer test would cost more than it saves.
constexpr std::size_t few = 6;
/// Parts of the cube along an axis that are tested one by one.
constexpr int parts = 3;

double distance_to(const Caster& caster, std::uint32_t triangle, const Vector3& point) {
  return (closest_on_triangle(point, caster.corner(triangle, 0), caster.corner(triangle, 1),
                              caster.corner(triangle, 2)) -
          point)
      .norm();
}

/// The triangles that can hold the closest point of some point of the cube, in
/// ascending order. A triangle is left out only if another one is closer to every part of the cube.
/// Conservative.
std::vector<std::uint32_t> closest_candidates(const Caster& caster, const Vector3& middle,
                                              double edge, double middle_distance) {
  // A point p of the cube is at most r from the middle m, so its closest triangle T has
  // |T - m| <= |T - p| + r <= |closest(m) - p| + r <= d(m) + 2 r.
  const double radius = edge * std::sqrt(3.0) / 2;
  std::vector<std::uint32_t> all;
  // Of a sheet what is felt is nearer than its middle.
  const double felt = 2 * caster.sheet_thickness();
  caster.within(middle, (std::abs(middle_distance) + 2 * radius + felt) * (1 + 1e-9), all);
  if (all.size() <= few) return all;

  std::vector<bool> needed(all.size(), false);
  std::vector<double> distance(all.size());
  for (int part = 0; part < parts * parts * parts; ++part) {
    const Vector3 place(part % parts, part / parts % parts, part / (parts * parts));
    const Vector3 point =
        middle + edge * ((place + Vector3::Constant(0.5)) / parts - Vector3::Constant(0.5));
    double nearest = std::numeric_limits<double>::infinity();
    for (std::size_t i = 0; i < all.size(); ++i) {
      distance[i] = distance_to(caster, all[i], point);
      nearest = std::min(nearest, distance[i]);
    }
    const double upper_bound = (nearest + 2 * radius / parts + felt) * (1 + 1e-9);
    for (std::size_t i = 0; i < all.size(); ++i)
      needed[i] = needed[i] || distance[i] <= upper_bound;
  }
  std::vector<std::uint32_t> kept;
  for (std::size_t i = 0; i < all.size(); ++i) {
    if (needed[i]) kept.push_back(all[i]);
  }
  return kept;
}

/// Octants cost bytes and bake time. They are made only where triangles would cost a tick more
/// time.
constexpr std::size_t few_triangles = 24;
/// With more splits, records became four times as many for a third less fallback.
constexpr int splits = 1;

/// Decides a cell. Where no few maps answer the whole cell, its octants are decided instead. Where
/// those cannot be split further, triangles answer.
void decide(PartitionCell& cell, const CellFitter& fitter, const Caster& caster, const Band& band,
            int level) {
  const double radius = cell.edge * std::sqrt(3.0) / 2;
  const ClosestPoint centre = caster.closest(cell.middle);
  if (centre.distance - radius > band.margin) return;
  if (centre.distance + radius < -band.max_depth) {
    cell.kind = CellKind::deep;
    cell.normal = pack_octahedral(centre.direction);
    return;
  }
  cell.kind = CellKind::record;
  if (fitter.fit(cell.middle, cell.edge, cell.maps)) return;
  cell.triangles = closest_candidates(caster, cell.middle, cell.edge, centre.distance);
  if (level == splits || cell.triangles.size() <= few_triangles) return;
  cell.triangles.clear();
  cell.octants = std::make_unique<std::array<PartitionCell, 8>>();
  for (std::size_t octant = 0; octant < 8; ++octant) {
    PartitionCell& part = (*cell.octants)[octant];
    part.edge = cell.edge / 2;
    part.middle = cell.middle + part.edge / 2 * octant_direction(octant);
    decide(part, fitter, caster, band, level + 1);
  }
}

void place_grid(Asset& asset) {
  GridData& grid = asset.grid;
  const AssetMetadata& metadata = asset.metadata;
  const double margin =
      metadata.band.margin * (1 + 1e-9) + 1e-6 * metadata.diagonal + metadata.sheet_thickness;
  const Vector3 low = metadata.box_min - Vector3::Constant(margin);
  const Vector3 size = metadata.box_max - metadata.box_min + Vector3::Constant(2 * margin);
  grid.cell_size = metadata.diagonal / cells_per_diagonal;
  double total = 1;
  for (std::size_t axis = 0; axis < 3; ++axis) {
    const double count = std::max(1.0, std::ceil(size[static_cast<int>(axis)] / grid.cell_size));
    total *= count;
    if (total > max_cells) {
      throw BakeError(
          ExitCode::invalid_input,
          "the margin is too wide for the object: the spatial partition would have more "
          "than 67 million cells; give a smaller --margin or --probe");
    }
    grid.cells[axis] = static_cast<std::uint32_t>(count);
  }
  grid.origin = low;
}

Vector3 middle_of(const GridData& grid, std::size_t cell) {
  const std::size_t x = cell % grid.cells[0];
  const std::size_t y = cell / grid.cells[0] % grid.cells[1];
  const std::size_t z = cell / grid.cells[0] / grid.cells[1];
  return grid.origin + grid.cell_size * (Vector3(static_cast<double>(x), static_cast<double>(y),
                                                 static_cast<double>(z)) +
                                         Vector3::Constant(0.5));
}

/// Numbers the triangles in use as in the file, in order of first use.
class TriangleStore {
 public:
  explicit TriangleStore(const Caster& caster) : caster_(caster) {}

  [[nodiscard]] std::uint32_t word_of(std::uint32_t triangle, std::vector<float>& corners) {
    const auto [place, fresh] =
        numbers_.try_emplace(triangle, static_cast<std::uint32_t>(numbers_.size()));
    if (fresh) {
      for (int corner = 0; corner < 3; ++corner) {
        for (int axis = 0; axis < 3; ++axis) {
          corners.push_back(static_cast<float>(caster_.corner(triangle, corner)[axis]));
        }
      }
    }
    return place->second << 1U | (caster_.is_sheet(triangle) ? 1U : 0U);
  }

 private:
  const Caster& caster_;
  std::map<std::uint32_t, std::uint32_t> numbers_;
};

/// Appends the records of cells to the grid, children after their parents.
class RecordWriter {
 public:
  RecordWriter(Asset& asset, const Caster& caster) : asset_(asset), store_(caster) {}
  PartitionCounts counts;

  /// The index word of a cell, after its records were appended.
  [[nodiscard]] std::uint32_t write(const PartitionCell& cell) {
    std::uint32_t payload = cell.normal;
    if (cell.kind == CellKind::record)
      payload = cell.octants ? write_split(cell) : write_record(cell);
    return static_cast<std::uint32_t>(cell.kind) << 30U | payload;
  }

 private:
  Asset& asset_;
  TriangleStore store_;

  [[nodiscard]] std::uint32_t next_offset() const {
    if (asset_.grid.records.size() > offset_mask) {
      throw BakeError(ExitCode::invalid_input,
                      "the spatial partition needs more than 268 million "
                      "words; simplify the mesh or narrow the band");
    }
    return static_cast<std::uint32_t>(asset_.grid.records.size());
  }

  std::uint32_t write_split(const PartitionCell& cell) {
    std::vector<std::uint32_t>& records = asset_.grid.records;
    const std::uint32_t offset = next_offset();
    records.resize(records.size() + 8);
    for (std::size_t octant = 0; octant < 8; ++octant) {
      const std::uint32_t word = write((*cell.octants)[octant]);
      records[offset + octant] = word;
    }
    return split_bit | offset;
  }

  std::uint32_t write_record(const PartitionCell& cell) {
    if (cell.triangles.size() > max_triangles) {
      throw BakeError(ExitCode::invalid_input,
                      std::to_string(cell.triangles.size()) +
                          " triangles crowd into one cell of the partition, more than the 65534 "
                          "that a record holds; simplify the mesh");
    }
    std::vector<std::uint32_t>& records = asset_.grid.records;
    const std::uint32_t offset = next_offset();
    records.push_back(list_header(static_cast<std::uint32_t>(cell.maps.size()),
                                  static_cast<std::uint32_t>(cell.triangles.size())));
    records.insert(records.end(), cell.maps.begin(), cell.maps.end());
    for (const std::uint32_t triangle : cell.triangles) {
      records.push_back(store_.word_of(triangle, asset_.triangles));
    }
    ++counts.records;
    counts.fallback += cell.triangles.empty() ? 0 : 1;
    return offset;
  }
};

}  // namespace

PartitionCounts partition_space(Asset& asset, const Caster& caster, double tolerance,
                                const Progress& progress) {
  place_grid(asset);
  GridData& grid = asset.grid;
  const Band& band = asset.metadata.band;
  const std::size_t count =
      std::size_t{grid.cells[0]} * std::size_t{grid.cells[1]} * std::size_t{grid.cells[2]};
  const AssetTables tables = tables_of(asset);
  const CellFitter fitter(tables.view(), grid, caster, band, tolerance);
  std::vector<PartitionCell> cells(count);
  ProgressCounter counter(progress, "partition", count);
  tbb::parallel_for(std::size_t{0}, count, [&](std::size_t i) {
    cells[i].middle = middle_of(grid, i);
    cells[i].edge = grid.cell_size;
    decide(cells[i], fitter, caster, band, 0);
    counter.done();
  });
  RecordWriter writer(asset, caster);
  grid.index.resize(count);
  for (std::size_t i = 0; i < count; ++i) grid.index[i] = writer.write(cells[i]);
  return writer.counts;
}

}  // namespace spm::baker
