// SPDX-License-Identifier: GPL-3.0-or-later
#include "tests/bench/geometry/cube_tree.hpp"

namespace spm::bench {

CubeTree::CubeTree(const Vector3& box_min, const Vector3& box_max, const Band& band)
    : band_(band), words_{far_word} {
  root_.low = box_min - Vector3::Constant(band.margin);
  root_.edge = (box_max - box_min).maxCoeff() + 2 * band.margin;
  per_root_ = 1 / root_.edge;
}

std::array<TreeCube, 8> CubeTree::split(const TreeCube& cube) {
  std::array<TreeCube, 8> octants;
  const auto first = static_cast<std::uint32_t>(words_.size());
  set(cube, first);
  for (std::uint32_t octant = 0; octant < 8; ++octant) {
    octants[octant] = cube.octant(octant);
    octants[octant].word = first + octant;
    words_.push_back(far_word);
  }
  return octants;
}

void CubeTree::fill_start(double largest_leaf) {
  while (std::ldexp(root_.edge, -static_cast<int>(start_levels_)) > largest_leaf) ++start_levels_;
  const std::uint32_t side = 1U << start_levels_;
  for (std::uint32_t z = 0; z < side; ++z) {
    for (std::uint32_t y = 0; y < side; ++y) {
      for (std::uint32_t x = 0; x < side; ++x) {
        std::uint32_t word = words_[0];
        for (std::uint32_t shift = start_levels_; word < leaf_bit && shift-- > 0;) {
          word = words_[word + (x >> shift & 1U) + 2 * (y >> shift & 1U) + 4 * (z >> shift & 1U)];
        }
        start_.push_back(word);
      }
    }
  }
}

std::optional<std::uint32_t> CubeTree::marker_of(const TreeCube& cube, double distance) const {
  if (distance - cube.radius() > band_.margin) return far_word;
  if (distance + cube.radius() < -band_.max_depth) return deep_word;
  return std::nullopt;
}

}  // namespace spm::bench
