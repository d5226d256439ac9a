// SPDX-License-Identifier: GPL-3.0-or-later
#include <nanovdb/util/OpenToNanoVDB.h>
#include <openvdb/openvdb.h>
#include <openvdb/tools/Prune.h>
#include <openvdb/tools/SignedFloodFill.h>

#include <array>
#include <cmath>
#include <cstdint>
#include <utility>

#include "common/base/units.hpp"
#include "tests/bench/geometry/trilinear.hpp"
#include "tests/bench/methods/methods.hpp"

namespace spm::bench {
namespace {

/// FpN takes as many bits as keep a voxel within this share of its size.
constexpr float variable_error = 1.0F / 200;

/// The lattice's values that are not clamped, in a tree whose other parts are filled by tiles.
openvdb::FloatGrid::Ptr make_grid(const DistanceLattice& lattice) {
  const auto inside = static_cast<float>(-lattice.inside);
  const auto outside = static_cast<float>(lattice.outside);
  auto grid = openvdb::FloatGrid::create(outside);
  openvdb::tree::ValueAccessor<openvdb::FloatTree> accessor(grid->tree());
  for (int z = 0; z < lattice.nodes[2]; ++z) {
    for (int y = 0; y < lattice.nodes[1]; ++y) {
      for (int x = 0; x < lattice.nodes[0]; ++x) {
        const float value = lattice.values[grid_number(lattice.nodes, {x, y, z})];
        if (value > inside && value < outside) accessor.setValue({x, y, z}, value);
      }
    }
  }
  openvdb::tools::signedFloodFillWithValues(grid->tree(), outside, -inside);
  openvdb::tools::prune(grid->tree());
  return grid;
}

/// Trilinear samples through an accessor that is kept, and the corners of the cube before, as both
/// libraries' own samplers do.
template <class Tree>
class VoxelField : public Method {
 public:
  VoxelField(const DistanceLattice& lattice, Tree tree)
      : origin_(lattice.origin), per_cell_(1 / lattice.cell), tree_(std::move(tree)) {
    facts_.name = Tree::name;
    facts_.settings = "voxel " + format_quantity(lattice.cell, Quantity::length);
    facts_.setting = lattice.cell;
    facts_.resident_bytes = tree_.bytes();
    facts_.file_bytes = facts_.resident_bytes;
  }

  /// What is known only to who makes it.
  void tell(const char* more, double build_seconds) {
    facts_.settings += more;
    facts_.build_seconds = build_seconds;
  }

  [[nodiscard]] Answer query(const Vector3& point) const noexcept override {
    const Vector3 scaled = (point - origin_) * per_cell_;
    CubeCorner cube{};
    CubePlace place{};
    for (std::size_t axis = 0; axis < 3; ++axis) {
      const double coordinate = scaled[static_cast<int>(axis)];
      // The coordinates in a tree are 32 bits wide.
      if (!(std::abs(coordinate) < 1e9)) return far_answer();
      cube[axis] = static_cast<int>(coordinate);
      if (coordinate < cube[axis]) --cube[axis];
      place[axis] = static_cast<float>(coordinate - cube[axis]);
    }
    if (cube != cube_) {
      cube_ = cube;
      read_corners();
    }
    return trilinear(corners_, place);
  }

 private:
  using CubeCorner = std::array<int, 3>;

  /// In most cubes all eight are in one leaf of 8x8x8 voxels, z fastest.
  void read_corners() const noexcept {
    const auto [x, y, z] = cube_;
    const auto low = [](int coordinate) { return static_cast<std::uint32_t>(coordinate) & 7U; };
    if (low(x) < 7 && low(y) < 7 && low(z) < 7 &&
        tree_.read_leaf(cube_, low(x) << 6U | low(y) << 3U | low(z), corners_)) {
      return;
    }
    for (std::size_t i = 0; i < corners_.size(); ++i) {
      corners_[i] = tree_.value(x + static_cast<int>(i & 1U), y + static_cast<int>(i >> 1U & 1U),
                                z + static_cast<int>(i >> 2U));
    }
  }

  Vector3 origin_;
  double per_cell_;  ///< 1/m
  Tree tree_;
  mutable CubeCorner cube_{1 << 30, 0, 0};  ///< the last one; at first none
  mutable CubeCorners corners_{};           ///< its values
};

/// How far the corners of a cube are from its first in a leaf.
constexpr std::array<std::uint32_t, 8> leaf_corners{0, 64, 8, 72, 1, 65, 9, 73};

class OpenTree {
 public:
  static constexpr const char* name = "openvdb";

  explicit OpenTree(openvdb::FloatGrid::Ptr grid)
      : grid_(std::move(grid)), accessor_(grid_->constTree()) {}

  [[nodiscard]] std::uint64_t bytes() const { return grid_->constTree().memUsage(); }

  [[nodiscard]] float value(int x, int y, int z) const { return accessor_.getValue({x, y, z}); }

  bool read_leaf(const std::array<int, 3>& cube, std::uint32_t first, CubeCorners& corners) const {
    const auto* leaf = accessor_.probeConstLeaf({cube[0], cube[1], cube[2]});
    if (leaf == nullptr) return false;
    const float* values = leaf->buffer().data() + first;
    for (std::size_t i = 0; i < corners.size(); ++i) corners[i] = values[leaf_corners[i]];
    return true;
  }

 private:
  openvdb::FloatGrid::Ptr grid_;
  // Not registered with the tree, because registering takes a lock.
  openvdb::tree::ValueAccessor<const openvdb::FloatTree, false> accessor_;
};

template <class Voxel>
class NanoTree {
 public:
  static constexpr const char* name = "nanovdb";

  explicit NanoTree(nanovdb::GridHandle<> handle)
      : handle_(std::move(handle)), accessor_(handle_.template grid<Voxel>()->tree().root()) {}

  [[nodiscard]] std::uint64_t bytes() const { return handle_.size(); }

  [[nodiscard]] float value(int x, int y, int z) const {
    return accessor_.getValue(nanovdb::Coord(x, y, z));
  }

  bool read_leaf(const std::array<int, 3>& cube, std::uint32_t first, CubeCorners& corners) const {
    const auto* leaf = accessor_.probeLeaf(nanovdb::Coord(cube[0], cube[1], cube[2]));
    if (leaf == nullptr) return false;
    for (std::size_t i = 0; i < corners.size(); ++i) {
      corners[i] = leaf->getValue(first + leaf_corners[i]);
    }
    return true;
  }

 private:
  nanovdb::GridHandle<> handle_;
  nanovdb::DefaultReadAccessor<Voxel> accessor_;
};

template <class Voxel>
std::unique_ptr<Method> make_nano(const DistanceLattice& lattice, const char* bits) {
  const Clock::time_point start = Clock::now();
  const openvdb::FloatGrid::Ptr grid = make_grid(lattice);
  nanovdb::OpenToNanoVDB<float, Voxel> convert;
  convert.oracle().setTolerance(variable_error * static_cast<float>(lattice.cell));
  auto made =
      std::make_unique<VoxelField<NanoTree<Voxel>>>(lattice, NanoTree<Voxel>(convert(*grid)));
  made->tell(bits, lattice.seconds + seconds_since(start));
  return made;
}

}  // namespace

std::unique_ptr<Method> make_openvdb(const DistanceLattice& lattice) {
  const Clock::time_point start = Clock::now();
  auto made = std::make_unique<VoxelField<OpenTree>>(lattice, OpenTree(make_grid(lattice)));
  made->tell("", lattice.seconds + seconds_since(start));
  return made;
}

std::unique_ptr<Method> make_nanovdb(const DistanceLattice& lattice, NanoVoxel voxel) {
  switch (voxel) {
    case NanoVoxel::fixed16:
      return make_nano<nanovdb::Fp16>(lattice, ", 16 bits");
    case NanoVoxel::fixed8:
      return make_nano<nanovdb::Fp8>(lattice, ", 8 bits");
    case NanoVoxel::variable:
      return make_nano<nanovdb::FpN>(lattice, ", variable bits");
    case NanoVoxel::float32:
      break;
  }
  return make_nano<float>(lattice, ", 32 bits");
}

}  // namespace spm::bench
