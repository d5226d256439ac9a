// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <cstdint>
#include <span>

#include "common/asset_view.hpp"

namespace spm {

/// What a cell of kind `record` names, whether its word holds it or a list does; see Grid. A view
/// that reads nothing outside the grid's words: a list that does not lie in them is empty.
class GridList {
 public:
  /// `word` is one of `index`, or of an octant, that is no split.
  GridList(const Grid& grid, std::uint32_t word) noexcept : narrow_(grid.narrow) {
    if ((word & inline_bit) != 0) {
      inlined_ = {word & inline_none, (word >> 14U) & inline_none};
      surfaces_ = inlined_[1] == inline_none ? 1 : 2;
      whole_ = true;
      return;
    }
    const std::size_t offset = word & offset_mask;
    if (offset >= grid.records.size()) return;
    const std::uint32_t header = grid.records[offset];
    const std::uint32_t surfaces = header & most_listed;
    const std::uint32_t triangles = (header >> 8U) & most_listed_triangles;
    const std::size_t words = number_words(std::size_t{surfaces} + triangles, narrow_);
    if (words > grid.records.size() - offset - 1) return;
    words_ = grid.records.subspan(offset + 1, words);
    surfaces_ = surfaces;
    triangles_ = triangles;
    side_ = static_cast<ListSide>((header >> 24U) & 3U);
    whole_ = (header >> 24U) <= static_cast<std::uint32_t>(ListSide::outside);
  }

  /// Words that `count` numbers of a list take.
  [[nodiscard]] static constexpr std::size_t number_words(std::size_t count, bool narrow) noexcept {
    return narrow ? (count + 1) / 2 : count;
  }

  [[nodiscard]] bool whole() const noexcept { return whole_; }
  [[nodiscard]] std::uint32_t surfaces() const noexcept { return surfaces_; }
  [[nodiscard]] std::uint32_t triangles() const noexcept { return triangles_; }
  [[nodiscard]] ListSide side() const noexcept { return side_; }
  /// A tile, or a map's candidate word; `which` is below surfaces().
  [[nodiscard]] std::uint32_t surface(std::uint32_t which) const noexcept { return number(which); }
  /// A triangle times two, plus one for a cap; `which` is below triangles().
  [[nodiscard]] std::uint32_t triangle(std::uint32_t which) const noexcept {
    return number(surfaces_ + which);
  }

 private:
  [[nodiscard]] std::uint32_t number(std::uint32_t which) const noexcept {
    if (words_.empty()) return inlined_[which];
    if (!narrow_) return words_[which];
    return (words_[which >> 1U] >> (16U * (which & 1U))) & 0xFFFFU;
  }

  std::span<const std::uint32_t> words_;
  std::array<std::uint32_t, 2> inlined_{};
  std::uint32_t surfaces_ = 0;
  std::uint32_t triangles_ = 0;
  ListSide side_ = ListSide::told;
  bool narrow_ = false;
  bool whole_ = false;
};

/// True where a word of the index, or of an octant, is a split cell.
[[nodiscard]] constexpr bool is_split(std::uint32_t word) noexcept {
  return static_cast<CellKind>(word >> 30U) == CellKind::record && (word & inline_bit) == 0 &&
         (word & split_bit) != 0;
}

}  // namespace spm
