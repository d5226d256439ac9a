// SPDX-License-Identifier: Apache-2.0
#include "common/asset/element_index.hpp"

namespace spm {

namespace {

/// A split word's octant, or the word itself. No branch, which would wait for the word.
std::uint32_t one_below(const ElementIndex& index, std::uint32_t word, const FinestCube& cube,
                        unsigned level) noexcept {
  const std::uint32_t is_split = -(word >> 31U);
  const std::uint32_t below =
      index.words[((word & ~index_split) + cube.octant(level - 1)) & is_split];
  return (below & is_split) | (word & ~is_split);
}

}  // namespace

void lists_at(const ElementIndex& index, std::span<const Vector3> points,
              IndexList* lists) noexcept {
  const std::size_t count = std::min(points.size(), points_at_once);
  if (index.words.empty()) {
    std::fill_n(lists, count, IndexList{});
    return;
  }
  std::array<FinestCube, points_at_once> cubes;
  std::array<std::uint32_t, points_at_once> words;
  for (std::size_t i = 0; i < count; ++i) cubes[i].find(index, points[i]);
  std::uint32_t any = 0;
  for (std::size_t i = 0; i < count; ++i) {
    words[i] = index.words[cubes[i].cell];
    any |= words[i];
  }
  for (unsigned level = index_levels; level > 0 && (any & index_split) != 0; --level) {
    any = 0;
    for (std::size_t i = 0; i < count; ++i) {
      words[i] = one_below(index, words[i], cubes[i], level);
      any |= words[i];
    }
  }
  for (std::size_t i = 0; i < count; ++i) {
    __builtin_prefetch(index.words.data() + (words[i] & index_place));
  }
  for (std::size_t i = 0; i < count; ++i) {
    lists[i] = cubes[i].is_in ? list_of(index, words[i]) : outside_grid;
  }
}

}  // namespace spm
