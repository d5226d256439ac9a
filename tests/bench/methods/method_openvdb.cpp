// SPDX-License-Identifier: GPL-3.0-or-later
#include <openvdb/openvdb.h>
#include <openvdb/tools/Prune.h>
#include <openvdb/tools/SignedFloodFill.h>

#include <cmath>

#include "common/base/units.hpp"
#include "tests/bench/geometry/trilinear.hpp"
#include "tests/bench/methods/methods.hpp"

namespace spm::bench {
namespace {

class OpenVdb : public Method {
 public:
  explicit OpenVdb(const DistanceLattice& lattice)
      : origin_(lattice.origin), cell_(lattice.cell), tree_(static_cast<float>(lattice.outside)) {
    const Clock::time_point start = Clock::now();
    fill(lattice);
    facts_.name = "openvdb";
    facts_.settings = "voxel " + format_quantity(lattice.cell, Quantity::length);
    facts_.setting = lattice.cell;
    facts_.bytes = tree_.memUsage();
    facts_.build_seconds = lattice.seconds + seconds_since(start);
  }

  [[nodiscard]] Answer query(const Vector3& point) const noexcept override {
    const Vector3 place = (point - origin_) / cell_;
    // The coordinates in a tree are 32 bits wide.
    if (!(place.lpNorm<Eigen::Infinity>() < 1e9)) return far_answer();
    const Vector3 cube = place.array().floor();
    // This accessor is not registered with the tree, because registering takes a lock.
    const openvdb::tree::ValueAccessor<const openvdb::FloatTree, false> accessor(tree_);
    CubeCorners corners{};
    for (std::size_t i = 0; i < corners.size(); ++i) {
      corners[i] = accessor.getValue({static_cast<int>(cube.x()) + static_cast<int>(i & 1U),
                                      static_cast<int>(cube.y()) + static_cast<int>(i >> 1U & 1U),
                                      static_cast<int>(cube.z()) + static_cast<int>(i >> 2U)});
    }
    return trilinear(corners, place - cube);
  }

 private:
  void fill(const DistanceLattice& lattice) {
    openvdb::tree::ValueAccessor<openvdb::FloatTree> accessor(tree_);
    const auto inside = static_cast<float>(-lattice.inside);
    const auto outside = static_cast<float>(lattice.outside);
    for (int z = 0; z < lattice.nodes[2]; ++z) {
      for (int y = 0; y < lattice.nodes[1]; ++y) {
        for (int x = 0; x < lattice.nodes[0]; ++x) {
          const float value = lattice.values[grid_number(lattice.nodes, {x, y, z})];
          if (value > inside && value < outside) accessor.setValue({x, y, z}, value);
        }
      }
    }
    openvdb::tools::signedFloodFillWithValues(tree_, outside, -inside);
    openvdb::tools::prune(tree_);
  }

  Vector3 origin_;
  double cell_;
  openvdb::FloatTree tree_;
};

}  // namespace

std::unique_ptr<Method> make_openvdb(const DistanceLattice& lattice) {
  return std::make_unique<OpenVdb>(lattice);
}

}  // namespace spm::bench
