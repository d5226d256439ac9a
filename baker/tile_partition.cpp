// SPDX-License-Identifier: GPL-3.0-or-later
#include "baker/tile_partition.hpp"

#include <tbb/parallel_for.h>

#include <algorithm>
#include <cmath>
#include <limits>

#include "baker/cube_decider.hpp"
#include "baker/fallback_triangles.hpp"
#include "baker/partition_records.hpp"
#include "baker/progress_counter.hpp"
#include "baker/random.hpp"
#include "baker/tile_fit.hpp"

namespace spm::baker {

namespace {

constexpr double cells_per_diagonal = 25;
/// Random places at which the finished lists are tried, and more about each place that failed.
constexpr std::uint64_t trials = 300'000;
constexpr std::uint64_t trials_about_failure = 48;
constexpr std::uint64_t mending_passes = 8;
/// Every second trial lies within so many tolerances of the surface.
constexpr double near_tolerances = 2;
/// How far about a failure more trials lie, in tolerances.
constexpr double about_tolerances = 3;

/// The grid over the band: the surface's box, widened by the margin.
void place_grid(Asset& asset, const Caster& caster) {
  Vector3 low = Vector3::Constant(std::numeric_limits<double>::infinity()), high = -low;
  for (std::uint32_t i = 0; i < caster.surface_count(); ++i) {
    for (int k = 0; k < 3; ++k) {
      low = low.cwiseMin(caster.corner(i, k));
      high = high.cwiseMax(caster.corner(i, k));
    }
  }
  GridData& grid = asset.grid;
  const double margin = asset.metadata.band.margin + *asset.metadata.tolerance;
  grid.cell_size = std::max((high - low).norm() / cells_per_diagonal, margin / 8);
  grid.origin = low - Vector3::Constant(margin);
  for (std::size_t axis = 0; axis < 3; ++axis) {
    const int k = static_cast<int>(axis);
    grid.cells[axis] = static_cast<std::uint32_t>(
                           std::floor((high[k] - low[k] + 2 * margin) / grid.cell_size)) +
                       1;
  }
}

/// Trial points over the surface's band by area.
class BandTrials {
 public:
  BandTrials(const Caster& caster, const Band& band, double tolerance, std::uint64_t seed)
      : caster_(caster), band_(band), tolerance_(tolerance), seed_(seed) {
    double sum = 0;
    for (std::uint32_t i = 0; i < caster.surface_count(); ++i) {
      const Vector3& a = caster.corner(i, 0);
      sum += (caster.corner(i, 1) - a).cross(caster.corner(i, 2) - a).norm();
      areas_.push_back(sum);
    }
  }

  [[nodiscard]] Vector3 point(std::uint64_t index) const {
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
    const double h = random_unit(seed_, 4 * index + 3);
    const double height = index % 2 == 0
                              ? near_tolerances * tolerance_ * (2 * h - 1)
                              : -band_.max_depth + (band_.max_depth + band_.margin) * h;
    const Vector3& a = caster_.corner(triangle, 0);
    return a + x * (caster_.corner(triangle, 1) - a) + y * (caster_.corner(triangle, 2) - a) +
           height * caster_.normal(triangle);
  }

 private:
  const Caster& caster_;
  Band band_;
  double tolerance_;
  std::uint64_t seed_;
  std::vector<double> areas_;
};

/// The leaf that holds a point; null outside the grid.
PartitionNode* leaf_at(const GridData& grid, std::vector<PartitionNode>& nodes,
                       const Vector3& point) {
  std::size_t cell = 0;
  for (std::size_t axis = 3; axis-- > 0;) {
    const int k = static_cast<int>(axis);
    const double place = std::floor((point[k] - grid.origin[k]) / grid.cell_size);
    if (!(place >= 0 && place < grid.cells[axis])) return nullptr;
    cell = cell * grid.cells[axis] + static_cast<std::size_t>(place);
  }
  PartitionNode* node = &nodes[cell];
  while (node->octants) {
    std::size_t octant = 0;
    for (unsigned axis = 0; axis < 3; ++axis) {
      const int k = static_cast<int>(axis);
      if (point[k] >= node->middle[k]) octant |= std::size_t{1} << axis;
    }
    node = &(*node->octants)[octant];
  }
  return node;
}

/// Tries the finished lists at places of their own and mends those that answer wrong: the lattice
/// trials of the cubes look nowhere closer than they are apart.
void mend_lists(const CubeDecider& decider, const Caster& caster, Asset& asset, double tolerance,
                std::vector<PartitionNode>& nodes) {
  const BandTrials band(caster, asset.metadata.band, tolerance, 0x3E9D);
  std::vector<Vector3> more;
  for (std::uint64_t pass = 0; pass < mending_passes; ++pass) {
    std::vector<Vector3> points = std::move(more);
    for (std::uint64_t i = 0; i < trials; ++i) points.push_back(band.point(pass * trials + i));
    std::vector<std::uint8_t> failed(points.size(), 0);
    tbb::parallel_for(std::size_t{0}, points.size(), [&](std::size_t i) {
      const PartitionNode* leaf = leaf_at(asset.grid, nodes, points[i]);
      failed[i] = leaf != nullptr && leaf->kind == CellKind::record && leaf->rule == 0 &&
                          !decider.answers(*leaf, points[i])
                      ? 1
                      : 0;
    });
    more.clear();
    for (std::size_t i = 0; i < points.size(); ++i) {
      if (failed[i] == 0) continue;
      PartitionNode* leaf = leaf_at(asset.grid, nodes, points[i]);
      if (!decider.answers(*leaf, points[i])) decider.mend(*leaf, points[i]);
      for (std::uint64_t k = 0; k < trials_about_failure; ++k) {
        const std::uint64_t index = 3 * (i * trials_about_failure + k);
        const std::uint64_t seed = pass + 0x3E9E;
        const Vector3 away(random_unit(seed, index), random_unit(seed, index + 1),
                           random_unit(seed, index + 2));
        more.push_back(points[i] +
                       about_tolerances * tolerance * (2 * away - Vector3::Constant(1)));
      }
    }
    if (more.empty()) return;
  }
}

}  // namespace

TilePartitionCounts partition_tiles(Asset& asset, const Caster& caster,
                                    const std::vector<SurfacePiece>& pieces, double tolerance,
                                    const PruneTest& prune, const Progress& progress) {
  place_grid(asset, caster);
  GridData& grid = asset.grid;
  std::vector<Tile> tiles;
  for (const TileData& data : asset.tiles) {
    tiles.push_back(view_of(data, asset.metadata.tile_spacing, asset.metadata.height_unit));
  }
  const FallbackTriangles fallback(caster, pieces, tolerance);
  const CubeDecider decider(asset, tiles, caster, fallback, tolerance, prune);
  const std::size_t count = std::size_t{grid.cells[0]} * grid.cells[1] * grid.cells[2];
  std::vector<PartitionNode> nodes(count);
  ProgressCounter counter(progress, "partition", count);
  tbb::parallel_for(std::size_t{0}, count, [&](std::size_t i) {
    PartitionNode& node = nodes[i];
    const Vector3 place(static_cast<double>(i % grid.cells[0]),
                        static_cast<double>(i / grid.cells[0] % grid.cells[1]),
                        static_cast<double>(i / grid.cells[0] / grid.cells[1]));
    node.edge = grid.cell_size;
    node.middle = grid.origin + grid.cell_size * (place + Vector3::Constant(0.5));
    const double distance = caster.closest(node.middle).distance;
    const double radius = node.edge * std::sqrt(3.0) / 2;
    const Band& band = asset.metadata.band;
    if (distance - radius <= band.margin + tolerance &&
        distance + radius >= -band.max_depth - tolerance) {
      decider.decide(node, decider.all_near(node.middle, node.edge, std::abs(distance)), 0);
    } else {
      decider.decide(node, {}, 0);
    }
    counter.done();
  });
  mend_lists(decider, caster, asset, tolerance, nodes);
  return write_records(asset, fallback, nodes);
}

}  // namespace spm::baker
