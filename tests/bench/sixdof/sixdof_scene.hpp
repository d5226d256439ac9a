// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <string>
#include <vector>

#include "baker/pipeline/bake.hpp"
#include "baker/surface/outer_surface.hpp"
#include "baker/verify/exact_surface.hpp"
#include "common/sixdof/surface_samples.hpp"

namespace spm::bench {

/// The tool is scaled to this bounding box diagonal, m.
inline constexpr double tool_diagonal = 0.06;

/// A mesh with its asset, the surface from which the peers are built, and the exact surface.
struct BakedObject {
  /// Scales the mesh to `diagonal` (m) and bakes it. Throws BakeError.
  BakedObject(const std::string& path, double diagonal, double tolerance);

  std::string name;
  baker::Mesh mesh;
  baker::OuterSurface surface;
  baker::ExactSurface truth;
  baker::BakeResult baked;
  AssetTables tables;

  [[nodiscard]] const AssetView& view() const noexcept { return tables.view(); }
};

/// Samples of a surface; their number is within a tenth of `count`. Throws BakeError.
[[nodiscard]] SurfaceSamples samples_of_count(const AssetView& asset, std::uint64_t count);

}  // namespace spm::bench
