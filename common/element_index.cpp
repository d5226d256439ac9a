// SPDX-License-Identifier: Apache-2.0
#include "common/element_index.hpp"

namespace spm {

namespace {

/// Where a point is in the grid, in the finest cubes along each axis.
struct FinestCube {
  std::array<std::uint32_t, 3> at{};
  std::uint32_t cell = 0;  ///< the grid's cube, 0 where it is in none
  bool is_in = true;
};

FinestCube finest_cube(const ElementIndex& index, const Vector3& point) noexcept {
  constexpr double finest = 1U << index_levels;
  FinestCube cube;
  for (std::size_t axis = 3; axis-- > 0;) {
    const int k = static_cast<int>(axis);
    const double position = (point[k] - index.origin[k]) * index.per_cell;
    const bool is_in = position >= 0 && position < static_cast<double>(index.cells[axis]);
    cube.is_in = cube.is_in && is_in;
    cube.at[axis] = is_in ? static_cast<std::uint32_t>(position * finest) : 0;
    cube.cell = cube.cell * index.cells[axis] + (cube.at[axis] >> index_levels);
  }
  return cube;
}

/// A split word's octant, or the word itself. No branch, which would wait for the word.
std::uint32_t one_below(const ElementIndex& index, std::uint32_t word,
                        const std::array<std::uint32_t, 3>& at, unsigned level) noexcept {
  const std::uint32_t is_split = -(word >> 31U);
  const std::uint32_t octant = ((at[0] >> (level - 1)) & 1U) | ((at[1] >> (level - 1)) & 1U) << 1U |
                               ((at[2] >> (level - 1)) & 1U) << 2U;
  const std::uint32_t below = index.words[((word & ~index_split) + octant) & is_split];
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
  for (std::size_t i = 0; i < count; ++i) cubes[i] = finest_cube(index, points[i]);
  std::uint32_t any = 0;
  for (std::size_t i = 0; i < count; ++i) {
    words[i] = index.words[cubes[i].cell];
    any |= words[i];
  }
  for (unsigned level = index_levels; level > 0 && (any & index_split) != 0; --level) {
    any = 0;
    for (std::size_t i = 0; i < count; ++i) {
      words[i] = one_below(index, words[i], cubes[i].at, level);
      any |= words[i];
    }
  }
  for (std::size_t i = 0; i < count; ++i) {
    __builtin_prefetch(index.words.data() + (words[i] & index_place));
  }
  for (std::size_t i = 0; i < count; ++i) {
    lists[i] = list_of(index, cubes[i].is_in ? words[i] : 0);
  }
}

}  // namespace spm
