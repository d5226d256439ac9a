// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <cstdint>
#include <span>

#include "common/asset/asset_view.hpp"
#include "common/base/octant.hpp"

namespace spm {

/// The list of a cell of kind `record`; see Grid. A view that reads nothing outside the grid's
/// words: a list that does not lie within them is empty.
class GridList {
 public:
  /// `word` is a word of `index` or of an octant, and not that of a split cell.
  GridList(const Grid& grid, std::uint32_t word) noexcept {
    const std::size_t offset = word & offset_mask;
    if (offset >= grid.records.size()) return;
    const std::uint32_t header = grid.records[offset];
    const std::uint32_t maps = header & max_listed;
    const std::uint32_t triangles = (header >> 8U) & max_listed_triangles;
    const std::size_t words = std::size_t{maps} + triangles;
    if (words > grid.records.size() - offset - 1) return;
    words_ = grid.records.subspan(offset + 1, words);
    maps_ = maps;
    triangles_ = triangles;
    whole_ = header >> 24U == 0;
  }

  [[nodiscard]] bool whole() const noexcept { return whole_; }
  [[nodiscard]] std::uint32_t maps() const noexcept { return maps_; }
  [[nodiscard]] std::uint32_t triangles() const noexcept { return triangles_; }
  /// A map's candidate word; `which` is below maps().
  [[nodiscard]] std::uint32_t map(std::uint32_t which) const noexcept { return words_[which]; }
  /// A triangle's number times two, plus one for a sheet's; `which` is below triangles().
  [[nodiscard]] std::uint32_t triangle(std::uint32_t which) const noexcept {
    return words_[maps_ + which];
  }

 private:
  std::span<const std::uint32_t> words_;
  std::uint32_t maps_ = 0;
  std::uint32_t triangles_ = 0;
  bool whole_ = false;
};

/// True where a word of the index, or of an octant, is that of a split cell.
[[nodiscard]] constexpr bool is_split(std::uint32_t word) noexcept {
  return static_cast<CellKind>(word >> 30U) == CellKind::record && (word & split_bit) != 0;
}

/// The word for the surroundings of a point: that of its grid cell, or of an octant of a split
/// cell.
[[nodiscard]] inline std::uint32_t grid_word_at(const Grid& grid, const Vector3& point) noexcept {
  constexpr std::uint32_t nothing = static_cast<std::uint32_t>(CellKind::far) << 30U;
  std::size_t cell = 0;
  std::array<double, 3> within{};  // place in the cell, 0 to 1
  for (std::size_t axis = 3; axis-- > 0;) {
    const double position =
        (point[static_cast<int>(axis)] - grid.origin[static_cast<int>(axis)]) / grid.cell_size;
    if (!(position >= 0 && position < static_cast<double>(grid.cells[axis]))) return nothing;
    const auto whole = static_cast<std::size_t>(position);
    cell = cell * grid.cells[axis] + whole;
    within[axis] = position - static_cast<double>(whole);
  }
  if (cell >= grid.index.size()) return nothing;
  std::uint32_t word = grid.index[cell];
  for (int level = 0; level < split_levels; ++level) {
    const std::size_t offset = word & offset_mask;
    if (!is_split(word) || offset + 8 > grid.records.size()) break;
    word = grid.records[offset + enter_octant(within)];
  }
  return word;
}

}  // namespace spm
