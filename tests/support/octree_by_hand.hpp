// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <algorithm>
#include <array>
#include <cstdint>
#include <initializer_list>
#include <stdexcept>
#include <utility>
#include <vector>

#include "common/field/distance_octree.hpp"
#include "common/field/indexed_triangles.hpp"
#include "common/field/triangle_list.hpp"
#include "formats/asset/asset.hpp"

namespace spm::test {

/// An exact triangle.
struct TriangleByHand {
  std::array<std::array<std::int32_t, 3>, 3> corners{};  ///< steps of the lattice from its middle
  FeatureSides sides = 0;
  bool thin = false;
};

/// Steps from the lattice's origin to its middle, about which corners are counted here.
inline constexpr std::int32_t lattice_middle = 1 << (corner_bits - 1U);

/// Sets where corners lie.
inline void set_lattice(OctreeData& octree, const Vector3& middle, double step) {
  octree.lattice_step = step;
  octree.lattice_origin = middle - step * Vector3::Constant(lattice_middle);
}

/// Takes all triangles and lists away.
inline void clear_triangles(OctreeData& octree) {
  for (auto* words : {&octree.corners, &octree.triangles, &octree.sides, &octree.lists}) {
    words->clear();
  }
}

/// Adds a triangle with corners of its own. Its number.
inline std::uint32_t add_triangle(OctreeData& octree, const TriangleByHand& triangle) {
  const auto number = static_cast<std::uint32_t>(octree.triangles.size() / 2);
  const auto append = [](std::vector<std::uint32_t>& words, std::uint64_t word) {
    words.push_back(static_cast<std::uint32_t>(word));
    words.push_back(static_cast<std::uint32_t>(word >> 32U));
  };
  std::array<std::uint32_t, 3> corners{};
  for (std::size_t k = 0; k < 3; ++k) {
    corners[k] = static_cast<std::uint32_t>(octree.corners.size() / 2);
    std::array<std::uint32_t, 3> steps{};
    for (std::size_t axis = 0; axis < 3; ++axis) {
      const std::int32_t step = triangle.corners[k][axis] + lattice_middle;
      if (step < 0 || step > static_cast<std::int32_t>(corner_mask)) {
        throw std::invalid_argument("a corner outside the lattice");
      }
      steps[axis] = static_cast<std::uint32_t>(step);
    }
    append(octree.corners, pack_three(steps));
  }
  append(octree.triangles, pack_three(corners, triangle.thin));
  if (number % 2 == 0) octree.sides.push_back(0);
  octree.sides.back() |= pack_traits({.sides = triangle.sides}) << 16U * (number % 2);
  return number;
}

/// The word of a root; `word` is the place of its first, or of a `far` one its distance.
[[nodiscard]] constexpr std::uint32_t root_word(OctreeKind kind, std::uint32_t word) {
  return static_cast<std::uint32_t>(kind) | word << 4U;
}

/// The kinds of octants that are all of one kind, except those named.
[[nodiscard]] inline std::uint32_t octant_kinds(
    OctreeKind rest, std::initializer_list<std::pair<std::uint32_t, OctreeKind>> named = {}) {
  std::uint32_t kinds = static_cast<std::uint32_t>(rest) * 0x11111111U;
  for (const auto& [octant, kind] : named) {
    kinds &= ~(15U << (4 * octant));
    kinds |= static_cast<std::uint32_t>(kind) << (4 * octant);
  }
  return kinds;
}

/// Adds a list of triangles in this order, and gives the two words of its cube. `bounds` are those
/// of its packets, where it has any; 0 where they are left out.
inline std::array<std::uint32_t, 2> add_list(OctreeData& octree,
                                             const std::vector<std::uint32_t>& solids,
                                             const std::vector<std::uint32_t>& sheets = {},
                                             ListSide side = ListSide::surface,
                                             const std::vector<std::uint32_t>& bounds = {}) {
  const auto first = static_cast<std::uint32_t>(octree.lists.size());
  const TriangleList list{.solids = static_cast<std::uint32_t>(solids.size()),
                          .sheets = static_cast<std::uint32_t>(sheets.size())};
  std::vector<std::uint32_t> numbers = solids, words(list.word_count(), 0);
  numbers.insert(numbers.end(), sheets.begin(), sheets.end());
  if (!numbers.empty()) words[0] = *std::min_element(numbers.begin(), numbers.end());
  for (std::size_t k = 0; k < numbers.size(); ++k) {
    words[1 + k / 2] |= (numbers[k] - words[0]) << 16U * (k % 2);
  }
  for (std::size_t k = 0; list.has_bounds() && k < std::min(bounds.size(), list.packets()); ++k) {
    words[list.number_words() + k / 4] |= bounds[k] << 8U * (k % 4);
  }
  octree.lists.insert(octree.lists.end(), words.begin(), words.end());
  return {first, list_word(list.solids, list.sheets, side, false)};
}

/// The words of a chain of this many splits, each the last octant of the one before; the last
/// octant of the last one is `end`. Its first word is at 0.
[[nodiscard]] inline std::vector<std::uint32_t> chain_of_splits(int splits, OctreeKind rest,
                                                                OctreeKind end) {
  std::vector<std::uint32_t> words;
  for (int split = 1; split <= splits; ++split) {
    words.push_back(static_cast<std::uint32_t>(2 * split));
    words.push_back(octant_kinds(rest, {{7, split == splits ? end : OctreeKind::split}}));
  }
  return words;
}

}  // namespace spm::test
