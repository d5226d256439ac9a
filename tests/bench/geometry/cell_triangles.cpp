// SPDX-License-Identifier: GPL-3.0-or-later
#include "tests/bench/geometry/cell_triangles.hpp"

#include <tbb/parallel_for.h>

#include <algorithm>
#include <cmath>
#include <numbers>

namespace spm::bench {
namespace {

constexpr int parts = 4;  ///< per side of a cell; a cell's list is the union of their lists

/// Adds the triangles that can be closest to a place in a cube, if the cube touches the band. A
/// triangle that is closest to a place in the cube is no farther from the middle of the cube than
/// the surface distance at the middle plus two half-diagonals.
void add_triangles(const Model& model, const Vector3& middle, double edge,
                   CellTriangles::List& found) {
  const double reach = std::numbers::sqrt3 / 2 * edge;
  const double distance = model.caster.closest(middle).distance;
  if (distance - reach > model.band.margin || distance + reach < -model.band.max_depth) return;
  CellTriangles::List near;
  model.caster.within(middle, std::abs(distance) + 2 * reach, near);
  found.insert(found.end(), near.begin(), near.end());
}

CellTriangles::Cell make_cell(const Model& model, const Vector3& low, double edge) {
  CellTriangles::Cell cell;
  const Vector3 middle = low + Vector3::Constant(edge / 2);
  const double reach = std::numbers::sqrt3 / 2 * edge;
  const double distance = model.caster.closest(middle).distance;
  cell.deep = distance < 0;
  if (distance - reach > model.band.margin || distance + reach < -model.band.max_depth) return cell;
  const double part = edge / parts;
  constexpr GridCounts counts{parts, parts, parts};
  for (std::size_t i = 0; i < grid_size(counts); ++i) {
    const Vector3 place = grid_vector(grid_place(counts, i)) + Vector3::Constant(0.5);
    add_triangles(model, low + part * place, part, cell.triangles);
  }
  std::sort(cell.triangles.begin(), cell.triangles.end());
  cell.triangles.erase(std::unique(cell.triangles.begin(), cell.triangles.end()),
                       cell.triangles.end());
  // Caps have no distance.
  std::erase_if(cell.triangles,
                [&](std::uint32_t triangle) { return model.caster.is_sheet(triangle); });
  return cell;
}

}  // namespace

CellTriangles find_cell_triangles(const Model& model, double cell) {
  const Clock::time_point start = Clock::now();
  CellTriangles found;
  found.cell = cell;
  found.origin = model.mesh.box_min - Vector3::Constant(model.band.margin);
  const Vector3 size = model.mesh.box_max + Vector3::Constant(model.band.margin) - found.origin;
  for (std::size_t axis = 0; axis < 3; ++axis) {
    found.counts[axis] = static_cast<int>(size[static_cast<int>(axis)] / cell) + 1;
  }
  found.cells.resize(grid_size(found.counts));
  tbb::parallel_for(std::size_t{0}, found.cells.size(), [&](std::size_t i) {
    const Vector3 place = grid_vector(grid_place(found.counts, i));
    found.cells[i] = make_cell(model, found.origin + cell * place, cell);
  });
  found.seconds = seconds_since(start);
  return found;
}

}  // namespace spm::bench
