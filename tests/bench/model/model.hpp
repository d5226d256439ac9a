// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <chrono>
#include <string>

#include "baker/cast/cast.hpp"
#include "baker/mesh/mesh.hpp"
#include "baker/surface/outer_surface.hpp"
#include "baker/verify/exact_surface.hpp"
#include "common/asset/asset_view.hpp"

namespace spm::bench {

/// The band that every method answers in, and the size that every mesh is scaled to; metres.
inline constexpr Band bench_band{0.002, 0.0005};
inline constexpr double bench_diagonal = 0.1;

/// A mesh file to measure on.
struct ModelSource {
  std::string name;
  std::string path;
  double tolerance = 1e-4;  ///< m: the methods are compared at this tolerance
};

/// The data from which the methods are built, and the ground truth, which shares no code with any
/// of them. Throws BakeError if no part of the mesh bounds a solid.
struct Model {
  Model(const ModelSource& source, baker::Mesh loaded);

  std::string name;
  double tolerance;  ///< m
  Band band = bench_band;
  baker::Mesh mesh;
  baker::OuterSurface surface;  ///< of the union of the mesh's parts
  baker::Caster caster;         ///< exact closest points for the methods' builds
  baker::ExactSurface truth;
};

using Clock = std::chrono::steady_clock;

[[nodiscard]] inline double seconds_since(Clock::time_point start) {
  return std::chrono::duration<double>(Clock::now() - start).count();
}

}  // namespace spm::bench
