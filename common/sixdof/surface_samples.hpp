// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <cstdint>
#include <vector>

#include "common/base/octahedral.hpp"
#include "common/sixdof/surface_patches.hpp"

namespace spm {

/// The part of a sample that the search for contacts reads: its position, and the distance from it
/// to the farthest of the finest samples that it represents; m.
struct SamplePlace {
  std::array<float, 3> position{};
  float radius = 0;  ///< 0 for the finest
};

/// The surface that a sample represents.
struct SampleShare {
  std::uint32_t packed_normal = 0;  ///< octahedral
  float area = 0;                   ///< m2
  /// Unit, out of the solid: the mean weighted by area.
  [[nodiscard]] Vector3 normal() const noexcept { return unpack_octahedral(packed_normal); }
};

/// How the surface of a sample lies about it.
struct SampleSpread {
  std::array<float, 3> middle{};  ///< m, from its position to the mean position of its surface
  /// m: half-extent of its surface from the middle, as of one that is spread evenly with the same
  /// variance.
  float spread = 0;
};

/// The children of a sample in the tree: `first` to `first + count - 1`, the first of which has the
/// same position; none for the finest.
struct SampleChildren {
  std::uint32_t first = 0;
  std::uint32_t count = 0;
};

/// One level: samples `first` to `first + count - 1`.
struct SampleLevel {
  std::uint32_t first = 0;
  std::uint32_t count = 0;
  double spacing = 0;  ///< m: edge of the cubes whose surface a sample represents
  double bound =
      0;  ///< m: upper bound of the distance from a place of the sampled surface to its sample
};

/// A surface as nested sets of samples, coarse ones first: a tree of spheres in flat arrays,
/// breadth first. On each level the areas add up to that of the surface.
struct SurfaceSamples {
  std::vector<SamplePlace> places;
  std::vector<SampleShare> shares;
  /// Those of the finest come last; contact alone does not need them.
  std::vector<SampleSpread> spreads;
  std::vector<SampleChildren> children;  ///< of those above the finest
  /// Of the same: the largest distance of the finest samples below it along its normal, in parts of
  /// its radius, of 65535, rounded up.
  std::vector<std::uint16_t> thicknesses;
  std::vector<SampleLevel> levels;
  double area = 0;                   ///< m2
  Vector3 centre = Vector3::Zero();  ///< of a ball around all samples, m
  double radius = 0;                 ///< m

  [[nodiscard]] bool is_finest(std::uint32_t sample) const noexcept {
    return sample >= children.size();
  }
  /// Of any sample.
  [[nodiscard]] SampleChildren below(std::uint32_t sample) const noexcept {
    return is_finest(sample) ? SampleChildren{} : children[sample];
  }
  [[nodiscard]] std::size_t bytes() const noexcept {
    return places.capacity() * sizeof(SamplePlace) + shares.capacity() * sizeof(SampleShare) +
           spreads.capacity() * sizeof(SampleSpread) +
           children.capacity() * sizeof(SampleChildren) +
           thicknesses.capacity() * sizeof(thicknesses[0]) +
           levels.capacity() * sizeof(SampleLevel);
  }
};

/// Samples a `sparse` asset's surface about `spacing` apart (m, above 0). In each cube of that
/// edge, the surface that faces one of six directions gets one sample; each coarser level doubles
/// the edge. Allocates: for loading, not for a tick. The same asset and spacing give the same
/// samples. Errors: those of surface_patches; usage where the spacing would need more than 2^21
/// cubes along a side.
[[nodiscard]] Result<SurfaceSamples> sample_surface(const AssetView& asset, double spacing);

/// Samples of one asset at several spacings, one after the other: the same as sample_surface, but
/// its pieces are kept. The asset must outlive it.
class SurfaceSampler {
 public:
  explicit SurfaceSampler(const AssetView& asset) noexcept : asset_(asset) {}
  [[nodiscard]] Result<SurfaceSamples> sample(double spacing);

 private:
  const AssetView& asset_;
  double step_ = -1;  ///< m, of the pieces; below 0 where there are none
  std::vector<SurfacePatch> patches_;
};

}  // namespace spm
