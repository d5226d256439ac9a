// SPDX-License-Identifier: GPL-3.0-or-later
#include "baker/full/partition_cell.hpp"

#include <cmath>

#include "baker/full/fallback.hpp"
#include "common/base/octahedral.hpp"
#include "common/base/octant.hpp"

namespace spm::baker {

namespace {

/// Octants cost bytes and bake time. They are made only where triangles would cost a tick more
/// time.
constexpr std::size_t few_triangles = 24;
/// With more splits, records became four times as many for a third less fallback.
constexpr int splits = 1;

}  // namespace

void decide(PartitionCell& cell, const CellFitter& fitter, const Caster& caster, const Band& band,
            int level) {
  const double radius = cell.edge * std::sqrt(3.0) / 2;
  const ClosestPoint centre = caster.closest(cell.middle);
  if (centre.distance - radius > band.margin) return;
  if (centre.distance + radius < -band.max_depth) {
    cell.kind = CellKind::deep;
    cell.normal = pack_octahedral(centre.direction);
    return;
  }
  cell.kind = CellKind::record;
  if (fitter.fit(cell.middle, cell.edge, cell.maps)) return;
  cell.triangles = closest_candidates(caster, cell.middle, cell.edge, centre.distance);
  if (level == splits || cell.triangles.size() <= few_triangles) return;
  cell.triangles.clear();
  cell.octants = std::make_unique<std::array<PartitionCell, 8>>();
  for (std::size_t octant = 0; octant < 8; ++octant) {
    PartitionCell& part = (*cell.octants)[octant];
    part.edge = cell.edge / 2;
    part.middle = cell.middle + part.edge / 2 * octant_direction(octant);
    decide(part, fitter, caster, band, level + 1);
  }
}

}  // namespace spm::baker
