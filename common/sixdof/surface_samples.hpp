// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <cstdint>
#include <vector>

#include "common/sixdof/surface_patches.hpp"

namespace spm {

/// What the search for contacts reads of a sample: where it is, and how far from it the finest
/// samples lie that it stands for; m.
struct SamplePlace {
  std::array<float, 3> position{};
  float radius = 0;  ///< 0 for the finest
};

/// What a sample stands for.
struct SampleShare {
  std::array<float, 3> normal{};  ///< unit, out of the solid: the mean by area
  float area = 0;                 ///< m2
  std::array<float, 3> middle{};  ///< m, from its position to the mean place of its surface
  /// m: its surface reaches so far from the middle, as one spread evenly with the same variance.
  float spread = 0;
};

/// Samples that lie one below the other: children of sample i are `first` to `first + count - 1`,
/// the first of which has the same position; none for the finest.
struct SampleChildren {
  std::uint32_t first = 0;
  std::uint32_t count = 0;
};

/// One level: samples `first` to `first + count - 1`.
struct SampleLevel {
  std::uint32_t first = 0;
  std::uint32_t count = 0;
  double spacing = 0;  ///< m: edge of the cubes whose surface a sample stands for
  double bound = 0;    ///< m: no place of the surface that was sampled is farther from its sample
};

/// A surface as nested sets of samples, coarse ones first: a tree of spheres in flat arrays,
/// breadth first. Of each level the areas add up to the surface's.
struct SurfaceSamples {
  std::vector<SamplePlace> places;
  std::vector<SampleShare> shares;
  std::vector<SampleChildren> children;
  std::vector<SampleLevel> levels;
  double area = 0;                   ///< m2
  Vector3 centre = Vector3::Zero();  ///< of a ball about all samples, m
  double radius = 0;                 ///< m
};

/// Samples a `sparse` asset's surface about `spacing` apart (m, above 0): one for the surface that
/// looks one of six ways in a cube of that edge; each level above doubles it. Allocates: for
/// loading, not for a tick. The same asset and spacing give the same samples. Errors: those of
/// surface_patches; usage where the spacing would need more than 2^21 cubes a side.
[[nodiscard]] Result<SurfaceSamples> sample_surface(const AssetView& asset, double spacing);

}  // namespace spm
