// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <array>
#include <cstdint>
#include <memory>
#include <vector>

#include "baker/full/cell_fit.hpp"

namespace spm::baker {

/// One cell of the partition after it was decided and before the records are laid out. It is far,
/// deep, a record of maps or triangles, or split into octants (x fastest).
struct PartitionCell {
  CellKind kind = CellKind::far;
  Vector3 middle = Vector3::Zero();
  double edge = 0;
  std::uint32_t normal = 0;              ///< of a deep cell, octahedral
  std::vector<std::uint32_t> maps;       ///< candidate words
  std::vector<std::uint32_t> triangles;  ///< of the caster
  std::unique_ptr<std::array<PartitionCell, 8>> octants;
};

/// Decides a cell. Where no few maps answer the whole cell, its octants are decided instead. Where
/// those cannot be split further, triangles answer.
void decide(PartitionCell& cell, const CellFitter& fitter, const Caster& caster, const Band& band,
            int level);

}  // namespace spm::baker
