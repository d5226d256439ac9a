// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "baker/base/stage_times.hpp"
#include "baker/smooth/smooth_options.hpp"
#include "baker/surface/outer_surface.hpp"

namespace spm::baker {

/// Counts of the rays cast.
struct CastCounts {
  std::uint64_t rays = 0;
  std::uint64_t inconsistent = 0;  ///< rays whose crossings did not alternate
  std::uint32_t layers_max = 0;    ///< most crossings met along one ray
};

/// The bytes of the file that were saved by a rule that leaves places out.
struct Pruned {
  std::string rule;  ///< workspace, probe or unreachable
  std::uint64_t bytes = 0;
};

/// Results of a bake, besides the asset.
struct BakeReport {
  std::uint64_t samples = 0;         ///< height samples stored
  std::uint64_t record_cells = 0;    ///< cells of space that touch the band
  std::uint64_t fallback_cells = 0;  ///< of them, cells that triangles answer
  double seconds_fit = 0;            ///< hull, planes, choice of maps and partition
  double seconds_cast = 0;
  StageTimes stages;
  std::vector<Pruned> pruned;
  std::vector<Hole> lids;  ///< holes closed by triangles that are felt, largest first
  std::vector<MeshFinding> found_in_surface;  ///< where parts of the mesh cross
  std::optional<SmoothReport> smooth;
  std::vector<std::string> notes;  ///< assumptions, a sentence each, for the user
};

}  // namespace spm::baker
