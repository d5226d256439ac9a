// SPDX-License-Identifier: GPL-3.0-or-later
#include "tests/bench/geometry/distance_lattice.hpp"

#include <tbb/parallel_for.h>

#include <algorithm>
#include <numbers>

namespace spm::bench {
namespace {

constexpr int block_nodes = 8;  ///< per side of a block; a block may be skipped as a whole

/// Samples the block of nodes that begins at `first`.
void sample_block(const Model& model, const GridCounts& first, DistanceLattice& lattice) {
  GridCounts last{};
  for (std::size_t axis = 0; axis < 3; ++axis) {
    last[axis] = std::min(first[axis] + block_nodes, lattice.nodes[axis]);
  }
  const auto distance_at = [&](const Vector3& node) {
    return model.caster.closest(lattice.origin + lattice.cell * node).distance;
  };
  constexpr double half = (block_nodes - 1) / 2.0;
  const double reach = half * std::numbers::sqrt3 * lattice.cell;
  const double middle = distance_at(grid_vector(first) + Vector3::Constant(half));
  const bool far = middle - reach > lattice.outside;
  const bool deep = middle + reach < -lattice.inside;
  for (int z = first[2]; z < last[2]; ++z) {
    for (int y = first[1]; y < last[1]; ++y) {
      for (int x = first[0]; x < last[0]; ++x) {
        double distance = far ? lattice.outside : -lattice.inside;
        if (!far && !deep) {
          distance = std::clamp(distance_at(Vector3(x, y, z)), -lattice.inside, lattice.outside);
        }
        lattice.values[grid_number(lattice.nodes, {x, y, z})] = static_cast<float>(distance);
      }
    }
  }
}

}  // namespace

DistanceLattice sample_band(const Model& model, double cell) {
  const Clock::time_point start = Clock::now();
  DistanceLattice lattice;
  lattice.cell = cell;
  // The corners of a cube are at most its diagonal away from any place in it.
  const double reach = 1.001 * std::numbers::sqrt3 * cell;
  lattice.inside = model.band.max_depth + reach;
  lattice.outside = model.band.margin + reach;
  const Vector3 grow = Vector3::Constant(model.band.margin);
  lattice.origin = model.mesh.box_min - grow;
  const Vector3 size = model.mesh.box_max + grow - lattice.origin;
  GridCounts blocks{};
  for (std::size_t axis = 0; axis < 3; ++axis) {
    // One more node than cubes, and one more cube than fits, so that upper faces have cubes too.
    lattice.nodes[axis] = static_cast<int>(size[static_cast<int>(axis)] / cell) + 2;
    blocks[axis] = (lattice.nodes[axis] + block_nodes - 1) / block_nodes;
  }
  lattice.values.resize(grid_size(lattice.nodes));
  tbb::parallel_for(std::size_t{0}, grid_size(blocks), [&](std::size_t i) {
    GridCounts first = grid_place(blocks, i);
    for (int& coordinate : first) coordinate *= block_nodes;
    sample_block(model, first, lattice);
  });
  lattice.seconds = seconds_since(start);
  return lattice;
}

}  // namespace spm::bench
