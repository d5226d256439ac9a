// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <cstdint>
#include <vector>

#include "tests/bench/geometry/grid_number.hpp"
#include "tests/bench/model/model.hpp"

namespace spm::bench {

/// For each cell of a regular grid around a model the triangles that can be closest to a place in
/// the cell and in the band.
struct CellTriangles {
  using List = std::vector<std::uint32_t>;

  struct Cell {
    List triangles;     ///< none: the cell does not touch the band
    bool deep = false;  ///< where there are none, whether it is inside
  };

  Vector3 origin = Vector3::Zero();
  double cell = 1;  ///< m
  GridCounts counts{};
  std::vector<Cell> cells;  ///< x fastest
  double seconds = 0;       ///< that it took to find them
};

[[nodiscard]] CellTriangles find_cell_triangles(const Model& model, double cell);

}  // namespace spm::bench
