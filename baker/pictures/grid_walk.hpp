// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <cstddef>
#include <cstdint>

#include "common/asset/grid_list.hpp"

namespace spm::baker {

/// Calls `visit` with the list of an index word, or with the lists of the octants of a split cell.
/// Splits that do not lie within the records are skipped.
template <class Visit>
void visit_lists(const Grid& grid, std::uint32_t word, const Visit& visit, int level = 0) {
  if (static_cast<CellKind>(word >> 30U) != CellKind::record) return;
  if (!is_split(word)) {
    visit(GridList(grid, word));
    return;
  }
  const std::size_t offset = word & offset_mask;
  if (level >= split_levels || offset + 8 > grid.records.size()) return;
  for (const std::uint32_t octant : grid.records.subspan(offset, 8)) {
    visit_lists(grid, octant, visit, level + 1);
  }
}

/// Calls `visit` with the list of every cell, and of every octant of split ones.
template <class Visit>
void visit_all_lists(const Grid& grid, const Visit& visit) {
  for (const std::uint32_t word : grid.index) visit_lists(grid, word, visit);
}

}  // namespace spm::baker
