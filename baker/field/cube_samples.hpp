// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <cstddef>
#include <cstdint>
#include <optional>
#include <vector>

#include "baker/field/cube_candidates.hpp"
#include "common/asset/asset_view.hpp"

namespace spm::baker {

/// A place of a cube, its signed distance (m) and the gradient of that.
struct CubeSample {
  Vector3 place = Vector3::Zero();  ///< from the middle, in halves of the edge
  double distance = 0;
  Vector3 gradient = Vector3::Zero();
  std::uint32_t triangle = 0;  ///< the nearest
};

/// Samples of the signed distance over a cube, from its candidates. `inside` is the side of the
/// whole cube; where it is empty the surface passes, and each sample finds its own.
[[nodiscard]] std::vector<CubeSample> sample_cube(const LatticeSurface& surface,
                                                  const Candidates& candidates, const Cube& cube,
                                                  std::optional<bool> inside);

/// Whether a sample lies in the band, or no more than `beyond` metres outside it.
[[nodiscard]] bool in_band(const CubeSample& sample, const Band& band, double beyond);

/// The numbers of the samples that do.
[[nodiscard]] std::vector<std::size_t> about_band(const std::vector<CubeSample>& samples,
                                                  const Band& band, double beyond);

/// Tells the chosen samples apart by their directions: for each sample, to which of two it belongs.
[[nodiscard]] std::vector<bool> by_direction(const std::vector<CubeSample>& samples,
                                             const std::vector<std::size_t>& chosen);

}  // namespace spm::baker
