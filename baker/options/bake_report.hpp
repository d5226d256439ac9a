// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "baker/smooth/smooth_options.hpp"
#include "baker/surface/outer_surface.hpp"

namespace spm::baker {

/// What casting the maps counted.
struct CastCounts {
  std::uint64_t rays = 0;
  std::uint64_t inconsistent = 0;  ///< rays whose crossings did not alternate
  std::uint32_t layers_max = 0;    ///< most crossings met along one ray
};

/// What a rule left out of an asset, in bytes of the file.
struct Pruned {
  std::string rule;  ///< workspace, probe or unreachable
  std::uint64_t bytes = 0;
};

/// What a bake measured of itself, beside the asset.
struct BakeReport {
  std::uint64_t samples = 0;  ///< height samples stored
  std::uint64_t rays = 0;
  std::uint64_t record_cells = 0;    ///< cells of space that touch the band
  std::uint64_t fallback_cells = 0;  ///< of them, cells that triangles answer
  // Of the sparse form's proof.
  std::uint64_t refused_tile_cells = 0;  ///< cells of tiles that resisted and were taken out
  std::uint64_t mended_places = 0;  ///< where space was divided since elements told the side wrong
  std::uint64_t wrong_trials = 0;   ///< trials of the side that resisted
  double fallback_area = 0;         ///< share of the surface that triangles stand for
  double direction = 0;             ///< median error of directions, rad, as the baker tried it
  double seconds_fit = 0;           ///< hull, planes, choice of maps and partition
  double seconds_cast = 0;
  std::vector<Pruned> pruned;
  std::vector<CappedHole> caps;  ///< holes closed for the side only, largest first
  std::optional<SmoothReport> smooth;
  std::vector<std::string> notes;  ///< what was assumed, a sentence each, for the user
};

}  // namespace spm::baker
