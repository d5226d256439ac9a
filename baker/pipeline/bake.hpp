// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <optional>

#include "baker/base/progress.hpp"
#include "baker/mesh/mesh.hpp"
#include "baker/options/bake_options.hpp"
#include "baker/options/bake_report.hpp"
#include "formats/asset/asset.hpp"

namespace spm::baker {

struct BakeResult {
  Asset asset;  ///< metadata complete but for tolerance_met, which the caller sets after verifying
  BakeReport report;
  std::optional<Mesh>
      smoothed;  ///< the smoothed mesh, which the asset then models in the mesh's place
};

/// Bakes a mesh: outer surface, hull, planes, ray casting, fit, spatial partition. Deterministic.
/// Throws BakeError: usage for options that contradict each other, invalid_input for meshes that it
/// cannot bake.
[[nodiscard]] BakeResult bake(const Mesh& mesh, const BakeOptions& options,
                              const Progress& progress = {});

}  // namespace spm::baker
