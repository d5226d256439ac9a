// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <Eigen/Geometry>
#include <cstdint>
#include <limits>
#include <span>
#include <vector>

#include "common/sixdof/surface_samples.hpp"
#include "common/surface/support_plane.hpp"

namespace spm {

/// A sampled surface as culling sees it: few points whose hull, grown by `grown`, contains it, and
/// of which its support mapping is taken.
struct SupportHull {
  std::vector<Vector3> points;
  double grown = 0;  ///< m
  Vector3 centre = Vector3::Zero();
  double radius = 0;  ///< m, of a ball about the centre that contains the surface

  /// m: no point of the surface is lower along a unit normal of its frame. Minus infinity where
  /// there are no points.
  [[nodiscard]] double lowest(const Vector3& normal) const noexcept;
};

/// Chooses samples until all others lie within a hundredth of the surface's radius of their hull.
/// Allocates: for loading.
[[nodiscard]] SupportHull support_hull(const SurfaceSamples& surface);

/// An object as culling sees it: its box, m, and the support planes of its baked file (Definition
/// 1), both of the size that was baked.
struct SupportedObject {
  Vector3 low = Vector3::Zero(), high = Vector3::Zero();
  std::span<const SupportPlane> planes;
  double scale = 1;  ///< from that size
};

/// Which test found two objects apart.
enum class CullStage : std::uint8_t { none, box, remembered, plane };

/// The plane that separated a pair last; none at first.
inline constexpr std::uint32_t no_plane = std::numeric_limits<std::uint32_t>::max();

/// Whether a surface is farther from an object than `reach` (m), before any sample's distance is
/// asked for (section 2.1: the step between bounding boxes and narrow phase). The tests, in this
/// order: the object's box and the surface's ball; the plane that separated the two last; the plane
/// M_O(v) that is most parallel to the way from the box to the ball's middle (Definition 2),
/// against the surface's support mapping. What is not found apart may still be, because hulls fill
/// hollows. `to_object` takes the surface's frame to the object's. Allocates nothing.
[[nodiscard]] CullStage objects_apart(const SupportedObject& object, const SupportHull& surface,
                                      const Eigen::Isometry3d& to_object, double reach,
                                      std::uint32_t& last) noexcept;

}  // namespace spm
