// SPDX-License-Identifier: GPL-3.0-or-later
#include "tests/bench/geometry/cube_tree.hpp"

#include "tests/bench/geometry/grid_number.hpp"

namespace spm::bench {

CubeTree::CubeTree(const Vector3& box_min, const Vector3& box_max, double margin)
    : words_{far_word} {
  root_.low = box_min - Vector3::Constant(margin);
  root_.edge = (box_max - box_min).maxCoeff() + 2 * margin;
  per_root_ = 1 / root_.edge;
}

std::array<TreeCube, 8> CubeTree::split(const TreeCube& cube) {
  std::array<TreeCube, 8> octants;
  const auto first = static_cast<std::uint32_t>(words_.size());
  set(cube, first);
  for (std::uint32_t octant = 0; octant < 8; ++octant) {
    const Vector3 at = grid_vector(grid_place({2, 2, 2}, octant));
    octants[octant] = {cube.low + cube.edge / 2 * at, cube.edge / 2, first + octant};
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

CubeTree::Found CubeTree::find(const Vector3& point) const noexcept {
  // 1 over the size of a cube so many levels above the finest.
  static constexpr std::array<float, top + 1> per_cube = [] {
    std::array<float, top + 1> result{};
    for (std::uint32_t i = 0; i <= top; ++i) result[i] = 1 / static_cast<float>(1U << i);
    return result;
  }();
  const Vector3 scaled = (point - root_.low) * per_root_;
  if (!(scaled.minCoeff() >= 0 && scaled.maxCoeff() < 1)) return {};
  // Bit by bit, from the highest, the coordinates name the octants.
  std::array<std::uint32_t, 3> at{};
  for (std::size_t axis = 0; axis < 3; ++axis) {
    at[axis] = static_cast<std::uint32_t>(scaled[static_cast<int>(axis)] * (1U << top));
  }
  std::uint32_t shift = top - start_levels_;
  Found found;
  found.word = start_[start_number(at[0] >> shift, at[1] >> shift, at[2] >> shift)];
  while (found.word < leaf_bit) {
    --shift;
    found.word = words_[found.word + (at[0] >> shift & 1U) + 2 * (at[1] >> shift & 1U) +
                        4 * (at[2] >> shift & 1U)];
  }
  for (std::size_t axis = 0; axis < 3; ++axis) {
    const std::uint32_t within = at[axis] & ((1U << shift) - 1);
    found.place[axis] = static_cast<float>(within) * per_cube[shift];
  }
  return found;
}

}  // namespace spm::bench
