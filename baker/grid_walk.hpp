// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <cstddef>
#include <cstdint>

#include "common/asset_view.hpp"

namespace spm::baker {

/// Calls `visit` with the record (its word in grid.records) of an index word, or with those of the
/// octants where the record is a split cell's. Offsets beyond the records are skipped.
template <class Visit>
void visit_records(const Grid& grid, std::uint32_t word, const Visit& visit, int level = 0) {
  if (static_cast<CellKind>(word >> 30U) != CellKind::record) return;
  const std::size_t offset = word & payload_mask;
  if (offset >= grid.records.size()) return;
  if (grid.records[offset] != split_header) {
    visit(offset);
    return;
  }
  if (level >= split_levels || offset + 9 > grid.records.size()) return;
  for (std::size_t octant = 0; octant < 8; ++octant) {
    visit_records(grid, grid.records[offset + 1 + octant], visit, level + 1);
  }
}

/// Calls `visit` with the record of every cell, and of every octant of split ones.
template <class Visit>
void visit_all_records(const Grid& grid, const Visit& visit) {
  for (const std::uint32_t word : grid.index) visit_records(grid, word, visit);
}

}  // namespace spm::baker
