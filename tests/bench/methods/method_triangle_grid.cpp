// SPDX-License-Identifier: GPL-3.0-or-later
#include <tbb/parallel_for.h>

#include <algorithm>
#include <cmath>
#include <map>
#include <numbers>
#include <vector>

#include "common/base/units.hpp"
#include "common/surface/closest_on_triangle.hpp"
#include "tests/bench/geometry/grid_number.hpp"
#include "tests/bench/geometry/nearest_point.hpp"
#include "tests/bench/geometry/trilinear.hpp"
#include "tests/bench/methods/methods.hpp"
#include "tests/bench/model/float_mesh.hpp"

namespace spm::bench {
namespace {

using List = std::vector<std::uint32_t>;

constexpr std::uint32_t far_cell = 0xFFFFFFFFU;
constexpr std::uint32_t deep_cell = 0xFFFFFFFEU;
constexpr int parts = 4;  ///< per side of a cell; a cell's list is the union of their lists

struct Layout {
  Vector3 origin = Vector3::Zero();
  double cell = 1;
  GridCounts cells{};
};

/// The content of a cell: a marker or a list.
struct Cell {
  std::uint32_t marker = far_cell;
  List triangles;
};

/// Adds the triangles that can be closest to a place in a cube, if the cube touches the band. A
/// triangle that is closest to a place in the cube is no farther from the middle of the cube than
/// the surface distance at the middle plus two half-diagonals.
void add_triangles(const Model& model, const Vector3& middle, double edge, List& found) {
  const double reach = std::numbers::sqrt3 / 2 * edge;
  const double distance = model.caster.closest(middle).distance;
  if (distance - reach > model.band.margin || distance + reach < -model.band.max_depth) return;
  List near;
  model.caster.within(middle, std::abs(distance) + 2 * reach, near);
  found.insert(found.end(), near.begin(), near.end());
}

Cell make_cell(const Model& model, const Vector3& low, double edge) {
  Cell cell;
  const Vector3 middle = low + Vector3::Constant(edge / 2);
  const double reach = std::numbers::sqrt3 / 2 * edge;
  const double distance = model.caster.closest(middle).distance;
  if (distance < 0) cell.marker = deep_cell;
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
                [&](std::uint32_t triangle) { return model.caster.is_cap(triangle); });
  return cell;
}

Layout layout_of(const Model& model, double cell) {
  Layout layout;
  layout.cell = cell;
  layout.origin = model.mesh.box_min - Vector3::Constant(model.band.margin);
  const Vector3 size = model.mesh.box_max + Vector3::Constant(model.band.margin) - layout.origin;
  for (std::size_t axis = 0; axis < 3; ++axis) {
    layout.cells[axis] = static_cast<int>(size[static_cast<int>(axis)] / cell) + 1;
  }
  return layout;
}

class TriangleGrid : public Method {
 public:
  TriangleGrid(const Model& model, double cell)
      : mesh_(model.surface),
        layout_(layout_of(model, cell)),
        band_(model.band),
        tie_(1e-7 * model.mesh.diagonal) {
    const Clock::time_point start = Clock::now();
    fill(model);
    facts_.name = "triangle-grid";
    facts_.settings = "cell " + format_quantity(cell, Quantity::length);
    facts_.setting = cell;
    facts_.bytes = 4 * (index_.size() + lists_.size()) + mesh_.bytes();
    facts_.build_seconds = seconds_since(start);
  }

  [[nodiscard]] Answer query(const Vector3& point) const noexcept override {
    const Vector3 place = (point - layout_.origin) / layout_.cell;
    GridCounts cell{};
    for (std::size_t axis = 0; axis < 3; ++axis) {
      const double coordinate = place[static_cast<int>(axis)];
      if (!(coordinate >= 0 && coordinate < layout_.cells[axis])) return far_answer();
      cell[axis] = static_cast<int>(coordinate);
    }
    const std::uint32_t word = index_[grid_number(layout_.cells, cell)];
    if (word == far_cell) return far_answer();
    if (word == deep_cell) return deep_answer(band_.max_depth);
    NearestPoint nearest(point, tie_);
    for (std::uint32_t i = 1; i <= lists_[word]; ++i) {
      const auto [a, b, c] = mesh_.corners(lists_[word + i]);
      nearest.show(closest_on_triangle(point, a, b, c), a, b, c);
    }
    return nearest.answer();
  }

 private:
  void fill(const Model& model) {
    std::vector<Cell> cells(grid_size(layout_.cells));
    tbb::parallel_for(std::size_t{0}, cells.size(), [&](std::size_t i) {
      const Vector3 place = grid_vector(grid_place(layout_.cells, i));
      cells[i] = make_cell(model, layout_.origin + layout_.cell * place, layout_.cell);
    });
    // Equal lists are stored once.
    std::map<List, std::uint32_t> known;
    index_.reserve(cells.size());
    for (const Cell& cell : cells) {
      if (cell.triangles.empty()) {
        index_.push_back(cell.marker);
        continue;
      }
      const auto [found, added] =
          known.try_emplace(cell.triangles, static_cast<std::uint32_t>(lists_.size()));
      index_.push_back(found->second);
      if (!added) continue;
      lists_.push_back(static_cast<std::uint32_t>(cell.triangles.size()));
      lists_.insert(lists_.end(), cell.triangles.begin(), cell.triangles.end());
    }
  }

  FloatMesh mesh_;
  Layout layout_;
  Band band_;
  double tie_;
  std::vector<std::uint32_t> index_;  ///< one per cell, x fastest: a marker or an index in lists_
  std::vector<std::uint32_t> lists_;  ///< each: the count, then the triangles
};

}  // namespace

std::unique_ptr<Method> make_triangle_grid(const Model& model, double cell) {
  return std::make_unique<TriangleGrid>(model, cell);
}

}  // namespace spm::bench
