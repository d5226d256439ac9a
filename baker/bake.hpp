// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <cstdint>
#include <functional>
#include <optional>
#include <string>

#include "baker/mesh.hpp"
#include "baker/oriented_box.hpp"
#include "baker/outer_surface.hpp"
#include "baker/planes.hpp"
#include "baker/smooth_options.hpp"
#include "formats/asset.hpp"

namespace spm::baker {

enum class Layers { automatic, scalar, limited };

/// Options of a bake as the command line gives them, SI.
struct BakeOptions {
  AssetForm form = AssetForm::sparse;
  std::optional<double> tolerance;  ///< sparse only; default a thousandth of the diagonal
  double max_depth = 0.002;
  std::optional<double> margin;  ///< default probe radius + max_depth / 4
  double probe_radius = 0;
  std::optional<OrientedBox> workspace;  ///< where the device's tool can be, asset's frame
  PlaneKind kind = PlaneKind::automatic;
  std::optional<std::size_t> planes;  ///< full only
  std::uint32_t resolution = 65;      ///< full only: samples a side of each map, 2 to 4097
  Layers layers = Layers::automatic;
  std::uint32_t layer_limit = 0;  ///< with Layers::limited, 1 to 255
  SmoothOptions smooth;
  std::uint64_t seed = 1;
  unsigned threads = 0;  ///< 0: as many as there are cores; never changes the output
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

struct BakeResult {
  Asset asset;  ///< metadata complete but for tolerance_met, which the caller sets after verifying
  BakeReport report;
  std::optional<Mesh> smoothed;  ///< what the asset stands for in the mesh's place
};

/// Called with a stage's name and how much of it is done, 0 to 1; may be empty.
using Progress = std::function<void(const char* stage, double done)>;

/// Bakes a mesh: outer surface, hull, planes, ray casting, fit, spatial partition. Deterministic.
/// Throws BakeError: usage for options that contradict, invalid_input for meshes it cannot bake.
[[nodiscard]] BakeResult bake(const Mesh& mesh, const BakeOptions& options,
                              const Progress& progress = {});

}  // namespace spm::baker
