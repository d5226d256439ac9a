// SPDX-License-Identifier: GPL-3.0-or-later
#include <cstddef>
#include <utility>

#include "common/base/units.hpp"
#include "tests/bench/geometry/trilinear.hpp"
#include "tests/bench/methods/methods.hpp"

namespace spm::bench {
namespace {

class DenseSdf : public Method {
 public:
  explicit DenseSdf(DistanceLattice lattice)
      : lattice_(std::move(lattice)),
        per_cell_(1 / lattice_.cell),
        row_(grid_number(lattice_.nodes, {0, 1, 0})),
        slab_(grid_number(lattice_.nodes, {0, 0, 1})) {
    facts_.name = "dense-sdf";
    facts_.settings = "cell " + format_quantity(lattice_.cell, Quantity::length);
    facts_.setting = lattice_.cell;
    facts_.file_bytes = facts_.resident_bytes = lattice_.values.size() * sizeof(float);
    facts_.build_seconds = lattice_.seconds;
  }

  [[nodiscard]] Answer query(const Vector3& point) const noexcept override {
    const Vector3 scaled = (point - lattice_.origin) * per_cell_;
    GridCounts cube{};
    CubePlace place{};
    for (std::size_t axis = 0; axis < 3; ++axis) {
      const double coordinate = scaled[static_cast<int>(axis)];
      if (!(coordinate >= 0 && coordinate < lattice_.nodes[axis] - 1)) return far_answer();
      cube[axis] = static_cast<int>(coordinate);
      place[axis] = static_cast<float>(coordinate - cube[axis]);
    }
    const float* first = lattice_.values.data() + grid_number(lattice_.nodes, cube);
    const float *up = first + row_, *next = first + slab_, *both = next + row_;
    return trilinear({first[0], first[1], up[0], up[1], next[0], next[1], both[0], both[1]}, place);
  }

 private:
  DistanceLattice lattice_;
  double per_cell_;         ///< 1/m
  std::size_t row_, slab_;  ///< from a node to the next along y and z
};

}  // namespace

std::unique_ptr<Method> make_dense_sdf(DistanceLattice lattice) {
  return std::make_unique<DenseSdf>(std::move(lattice));
}

}  // namespace spm::bench
