// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <Eigen/Geometry>
#include <cstddef>
#include <cstdint>
#include <vector>

#include "common/surface/support_plane.hpp"
#include "common/sixdof/surface_samples.hpp"

namespace spm {

/// An object as the culling sees it: few points whose hull, grown by `grown`, holds all of it, and
/// support planes around them. The object's frame, m.
struct SupportHull {
  std::vector<Vector3> points;
  std::vector<SupportPlane> planes;  ///< of evenly spread normals (Definition 1)
  Vector3 centre = Vector3::Zero();
  double radius = 0;  ///< of a ball about the centre that holds the object
  double grown = 0;
};

/// Chooses points of a sampled surface until all others lie within `tolerance` (m, above 0) of
/// their hull; `planes` support planes. Allocates: for loading.
[[nodiscard]] SupportHull support_hull(const SurfaceSamples& samples, double tolerance,
                                       std::size_t planes);

/// What is remembered of a pair between ticks: the direction that separated it last.
struct SeparatingDirection {
  Vector3 direction = Vector3::Zero();  ///< unit, of the first object's frame; zero: none yet
};

/// How objects_apart came to its answer.
enum class CullStage : std::uint8_t { ball, remembered, plane, search, none };

struct CullResult {
  bool apart = false;
  CullStage stage = CullStage::none;  ///< that told them apart
  double least = 0;                   ///< m: they are at least so far from each other
};

/// Steps of the search at most.
inline constexpr int most_cull_steps = 16;

/// Whether two objects are apart, by their support planes (section 2.1, the step between bounding
/// boxes and narrow phase). In this order: balls; the direction that separated them last; the first
/// object's plane M_1(v) that looks most along the line of their centres (Definition 2), against
/// the other's support mapping; then directions that follow each other towards the nearest places
/// of both hulls. What is not apart may still be: hulls fill hollows. `pose2` takes object 2's
/// frame to object 1's. Allocates nothing, a bounded number of steps.
[[nodiscard]] CullResult objects_apart(const SupportHull& object1, const SupportHull& object2,
                                       const Eigen::Isometry3d& pose2,
                                       SeparatingDirection& last) noexcept;

}  // namespace spm
