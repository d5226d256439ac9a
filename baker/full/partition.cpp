// SPDX-License-Identifier: GPL-3.0-or-later
#include "baker/full/partition.hpp"

#include <tbb/parallel_for.h>

#include <algorithm>
#include <cmath>
#include <map>
#include <string>
#include <utility>

#include "baker/base/bake_error.hpp"
#include "baker/base/progress_counter.hpp"
#include "baker/full/cell_fit.hpp"
#include "baker/full/partition_cell.hpp"

namespace spm::baker {

namespace {

constexpr double cells_per_diagonal = 64;
/// A grid of more cells than this would not be worth its index.
constexpr double max_cells = 1 << 26;
/// A header with all bits set belongs to a split cell.
constexpr std::size_t max_triangles = 0xFFFE;

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
