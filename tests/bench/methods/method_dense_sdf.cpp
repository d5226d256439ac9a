// SPDX-License-Identifier: GPL-3.0-or-later
#include <algorithm>
#include <utility>

#include "common/base/units.hpp"
#include "tests/bench/geometry/trilinear.hpp"
#include "tests/bench/methods/methods.hpp"

namespace spm::bench {
namespace {

class DenseSdf : public Method {
 public:
  explicit DenseSdf(DistanceLattice lattice) : lattice_(std::move(lattice)) {
    facts_.name = "dense-sdf";
    facts_.settings = "cell " + format_quantity(lattice_.cell, Quantity::length);
    facts_.setting = lattice_.cell;
    facts_.bytes = lattice_.values.size() * sizeof(float);
    facts_.build_seconds = lattice_.seconds;
  }

  [[nodiscard]] Answer query(const Vector3& point) const noexcept override {
    Vector3 place = (point - lattice_.origin) / lattice_.cell;
    GridCounts cube{};
    for (std::size_t axis = 0; axis < 3; ++axis) {
      double& coordinate = place[static_cast<int>(axis)];
      if (!(coordinate >= 0 && coordinate < lattice_.nodes[axis] - 1)) return far_answer();
      cube[axis] = static_cast<int>(coordinate);
      coordinate -= cube[axis];
    }
    CubeCorners corners{};
    for (std::size_t i = 0; i < corners.size(); ++i) {
      const auto bit = [i](unsigned axis) { return static_cast<int>(i >> axis & 1U); };
      corners[i] = lattice_.values[grid_number(
          lattice_.nodes, {cube[0] + bit(0), cube[1] + bit(1), cube[2] + bit(2)})];
    }
    return trilinear(corners, place);
  }

 private:
  DistanceLattice lattice_;
};

}  // namespace

std::unique_ptr<Method> make_dense_sdf(DistanceLattice lattice) {
  return std::make_unique<DenseSdf>(std::move(lattice));
}

}  // namespace spm::bench
