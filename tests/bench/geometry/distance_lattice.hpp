// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <vector>

#include "tests/bench/geometry/grid_number.hpp"
#include "tests/bench/model/model.hpp"

namespace spm::bench {

/// Signed distances at the nodes of a regular lattice around a model, metres: exact at every corner
/// of every cube that touches the band, clamped to the band beyond.
struct DistanceLattice {
  Vector3 origin = Vector3::Zero();
  double cell = 1;            ///< m
  GridCounts nodes{};         ///< along each axis
  double inside = 0;          ///< m; values at and below its negative are clamped
  double outside = 0;         ///< m; values at and above it are clamped
  std::vector<float> values;  ///< x fastest
  double seconds = 0;         ///< that the computation took
};

/// Takes distances and sides from the baker's caster, so that no rival has a worse inside test.
[[nodiscard]] DistanceLattice sample_band(const Model& model, double cell);

}  // namespace spm::bench
