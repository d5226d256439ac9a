// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <array>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <vector>

#include "common/base/vector.hpp"
#include "tests/bench/geometry/trilinear.hpp"

namespace spm::bench {

/// A cube of a tree while that is built.
struct TreeCube {
  Vector3 low = Vector3::Zero();
  double edge = 0;
  std::uint32_t word = 0;  ///< its place in the tree

  [[nodiscard]] Vector3 middle() const { return low + Vector3::Constant(edge / 2); }
  [[nodiscard]] double radius() const { return std::sqrt(3.0) / 2 * edge; }
};

/// An octree as words. The word of a cube is a marker, a leaf's number with `leaf_bit`, or the
/// first of its octants' eight words.
class CubeTree {
 public:
  static constexpr std::uint32_t far_word = 0xFFFFFFFFU;
  static constexpr std::uint32_t deep_word = 0xFFFFFFFEU;
  static constexpr std::uint32_t leaf_bit = 1U << 31U;

  /// Of the box of a model and its margin, m; it starts with one cube.
  CubeTree(const Vector3& box_min, const Vector3& box_max, double margin);

  [[nodiscard]] const TreeCube& root() const { return root_; }
  void set(const TreeCube& cube, std::uint32_t word) { words_[cube.word] = word; }
  /// Makes a cube's octants, in the order of their words.
  [[nodiscard]] std::array<TreeCube, 8> split(const TreeCube& cube);
  /// Cubes larger than any leaf, m, are skipped by a table of all cubes of the next smaller size.
  void fill_start(double largest_leaf);

  struct Found {
    std::uint32_t word = far_word;  ///< of the leaf, or a marker
    CubePlace place{};              ///< in its cube
  };
  [[nodiscard]] Found find(const Vector3& point) const noexcept;

  /// Bytes of the words, and of these with the table.
  [[nodiscard]] std::uint64_t file_bytes() const { return words_.size() * sizeof(words_[0]); }
  [[nodiscard]] std::uint64_t resident_bytes() const {
    return file_bytes() + start_.size() * sizeof(start_[0]);
  }

 private:
  static constexpr std::uint32_t top = 30;  ///< bits of a coordinate

  TreeCube root_;
  double per_root_ = 0;  ///< 1/m
  std::uint32_t start_levels_ = 0;
  std::vector<std::uint32_t> start_;  ///< words of all cubes at that level, x fastest
  std::vector<std::uint32_t> words_;

  [[nodiscard]] std::size_t start_number(std::uint32_t x, std::uint32_t y,
                                         std::uint32_t z) const noexcept {
    return x + ((y + (static_cast<std::size_t>(z) << start_levels_)) << start_levels_);
  }
};

}  // namespace spm::bench
