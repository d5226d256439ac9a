// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <cstdint>
#include <functional>
#include <vector>

#include "common/asset/asset_view.hpp"
#include "formats/asset/asset.hpp"
#include "tests/support/shapes.hpp"

namespace spm::test {

/// One map and what its view points to; heights are a function of the plane's parameters.
struct MapByHand {
  std::vector<float> samples;
  std::vector<std::uint32_t> offsets;
  std::vector<std::uint32_t> mask;
  DistanceMap map;
};

using Heights = std::function<double(std::uint32_t layer, double eta, double omega)>;

/// A map of `columns` x `rows` samples from (eta0, omega0) on plane `plane`, all cells valid.
[[nodiscard]] MapByHand map_by_hand(std::uint32_t plane, std::uint32_t columns, std::uint32_t rows,
                                    std::uint32_t layers, double eta0, double omega0,
                                    double spacing, const Heights& heights);

/// A box of full edge lengths `size` about the origin as a `full` asset: six faces, one map each
/// with 17 x 17 samples, two layers, and a grid of one cell whose list has the entry layers.
class BoxByHand {
 public:
  explicit BoxByHand(const Vector3& size, const Band& band = {0.002, 0.0005});
  BoxByHand(const BoxByHand&) = delete;
  BoxByHand& operator=(const BoxByHand&) = delete;

  std::vector<SupportPlane> planes;
  std::vector<MapByHand> by_hand;
  std::vector<DistanceMap> maps;
  std::vector<double> nx, ny, nz, offset;
  std::vector<std::uint32_t> index, records;
  std::vector<float> triangles;
  AssetView view;

  /// Points the view at the vectors again, after a test changed them.
  void refresh();
};

/// A cube of edge length `size` about the origin as a `sparse` asset: an octree of one cube, whose
/// list has the twelve triangles. Support planes on the six faces, in the order of BoxByHand.
class SparseCubeByHand {
 public:
  explicit SparseCubeByHand(double size, const Band& band = {0.002, 0.0005});
  SparseCubeByHand(const SparseCubeByHand&) = delete;
  SparseCubeByHand& operator=(const SparseCubeByHand&) = delete;

  std::vector<SupportPlane> planes;
  OctreeData octree;
  AssetView view;

  /// Steps from the middle to a face on the lattice of the corners.
  static constexpr std::int32_t half_steps = 1 << 14;

  /// Makes the octree's list that of another shape, which lies within the cube of the octree, and
  /// the mesh's box that of the shape.
  void replace_triangles(const Shape& shape);
  /// Takes the mesh's box away, which then tells nothing of how far the surface is.
  void forget_box();
  /// Points the view at the vectors again, after a test changed them.
  void refresh();
};

}  // namespace spm::test
