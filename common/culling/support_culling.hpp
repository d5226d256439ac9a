// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <Eigen/Geometry>
#include <cstddef>
#include <cstdint>
#include <vector>

#include "common/sixdof/surface_samples.hpp"
#include "common/surface/support_plane.hpp"

namespace spm {

/// An object as culling sees it: a few points whose hull, grown by `grown`, contains the object,
/// and support planes around it. In the object's frame, m.
struct SupportHull {
  std::vector<Vector3> points;
  std::vector<SupportPlane> planes;  ///< of evenly spread normals (Definition 1)
  Vector3 centre = Vector3::Zero();
  double radius = 0;  ///< of a ball about the centre that contains the object
  double grown = 0;
};

/// Chooses points of a sampled surface until all others lie within `tolerance` (m, above 0) of
/// their hull, and `planes` support planes. Allocates: for loading.
[[nodiscard]] SupportHull support_hull(const SurfaceSamples& samples, double tolerance,
                                       std::size_t planes);

/// The memory of a pair between ticks: the direction that separated it last.
struct SeparatingDirection {
  Vector3 direction = Vector3::Zero();  ///< unit, in the first object's frame; zero: none yet
};

/// How objects_apart came to its answer.
enum class CullStage : std::uint8_t { ball, remembered, plane, search, none };

struct CullResult {
  bool apart = false;
  CullStage stage = CullStage::none;  ///< the stage that separated them
  double lower_bound = 0;             ///< m: lower bound of their distance
};

/// Largest number of steps of the search.
inline constexpr int max_cull_steps = 16;

/// Whether two objects are apart, by their support planes (section 2.1: the step between bounding
/// boxes and narrow phase). The tests, in this order: balls; the direction that separated the pair
/// last; the first object's plane M_1(v) that is most parallel to the line between their centres
/// (Definition 2), against the other's support mapping; then a search whose directions converge
/// towards the nearest places of both hulls. Objects that are not found apart may still be apart,
/// because hulls fill hollows. `pose2` takes object 2's frame to object 1's. Allocates nothing, and
/// takes a bounded number of steps.
[[nodiscard]] CullResult objects_apart(const SupportHull& object1, const SupportHull& object2,
                                       const Eigen::Isometry3d& pose2,
                                       SeparatingDirection& last) noexcept;

}  // namespace spm
