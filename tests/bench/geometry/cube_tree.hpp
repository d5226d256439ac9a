// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <array>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <optional>
#include <vector>

#include "common/base/octant.hpp"
#include "common/base/vector.hpp"
#include "common/query/query.hpp"
#include "tests/bench/geometry/trilinear.hpp"

namespace spm::bench {

/// A cube of a tree while that is built.
struct TreeCube {
  Vector3 low = Vector3::Zero();
  double edge = 0;
  std::uint32_t word = 0;  ///< its place in the tree

  [[nodiscard]] Vector3 middle() const { return low + Vector3::Constant(edge / 2); }
  [[nodiscard]] double radius() const { return std::sqrt(3.0) / 2 * edge; }
  /// Its octant; without a place in the tree.
  [[nodiscard]] TreeCube octant(std::uint32_t number) const {
    const Vector3 upper(is_upper(number, 0), is_upper(number, 1), is_upper(number, 2));
    return {low + edge / 2 * upper, edge / 2};
  }
};

/// An octree as words. The word of a cube is a marker, a leaf's number with `leaf_bit`, or the
/// first of its octants' eight words.
class CubeTree {
 public:
  static constexpr std::uint32_t far_word = 0xFFFFFFFFU;
  static constexpr std::uint32_t deep_word = 0xFFFFFFFEU;
  static constexpr std::uint32_t leaf_bit = 1U << 31U;

  /// Of the box of a model and a band about its surface, m; it starts with one cube.
  CubeTree(const Vector3& box_min, const Vector3& box_max, const Band& band);

  [[nodiscard]] const TreeCube& root() const { return root_; }
  void set(const TreeCube& cube, std::uint32_t word) { words_[cube.word] = word; }
  /// Makes a cube's octants, in the order of their words.
  [[nodiscard]] std::array<TreeCube, 8> split(const TreeCube& cube);
  /// Cubes larger than any leaf, m, are skipped by a table of all cubes of the next smaller size.
  void fill_start(double largest_leaf);

  /// The marker of a cube that lies wholly beyond the band; `distance` is its middle's, signed, m.
  [[nodiscard]] std::optional<std::uint32_t> marker_of(const TreeCube& cube, double distance) const;

  /// The answer at a point: of its leaf, by number and place in it, or of the marker there.
  template <class OfLeaf>
  [[nodiscard]] Answer answer(const Vector3& point, const OfLeaf& of_leaf) const noexcept {
    const Vector3 scaled = (point - root_.low) * per_root_;
    if (!(scaled.minCoeff() >= 0 && scaled.maxCoeff() < 1)) return far_answer();
    // Bit by bit, from the highest, the coordinates name the octants.
    std::array<std::uint32_t, 3> at{};
    for (std::size_t axis = 0; axis < 3; ++axis) {
      at[axis] = static_cast<std::uint32_t>(scaled[static_cast<int>(axis)] * (1U << top));
    }
    std::uint32_t shift = top - start_levels_;
    std::uint32_t word = start_[start_number(at[0] >> shift, at[1] >> shift, at[2] >> shift)];
    while (word < leaf_bit) {
      --shift;
      word = words_[word + (at[0] >> shift & 1U) + 2 * (at[1] >> shift & 1U) +
                    4 * (at[2] >> shift & 1U)];
    }
    if (word == far_word) return far_answer();
    if (word == deep_word) return deep_answer(band_.max_depth);
    CubePlace place{};
    for (std::size_t axis = 0; axis < 3; ++axis) {
      const std::uint32_t within = at[axis] & ((1U << shift) - 1);
      place[axis] = static_cast<float>(within) * per_cube[shift];
    }
    return of_leaf(word & ~leaf_bit, place);
  }

  /// Bytes of the words, and of these with the table.
  [[nodiscard]] std::uint64_t file_bytes() const { return words_.size() * sizeof(words_[0]); }
  [[nodiscard]] std::uint64_t resident_bytes() const {
    return file_bytes() + start_.size() * sizeof(start_[0]);
  }

 private:
  static constexpr std::uint32_t top = 30;  ///< bits of a coordinate
  /// 1 over the size of a cube so many levels above the finest.
  static constexpr std::array<float, top + 1> per_cube = [] {
    std::array<float, top + 1> result{};
    for (std::uint32_t i = 0; i <= top; ++i) result[i] = 1 / static_cast<float>(1U << i);
    return result;
  }();

  Band band_;
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
