// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <Eigen/Geometry>
#include <cstdint>

#include "common/asset/asset_view.hpp"
#include "common/base/wrench.hpp"
#include "common/sixdof/surface_samples.hpp"

namespace spm {

/// The input of overlap_volume for one object: its baked field and samples of its surface.
struct SampledObject {
  const AssetView* field = nullptr;
  const SurfaceSamples* samples = nullptr;
};

/// The overlap of two objects; object 1's frame.
struct OverlapVolume {
  double volume = 0;                 ///< m3
  Vector3 centre = Vector3::Zero();  ///< centre of gravity, m; zero where there is no volume
  /// m2: minus the flux of object 2's outward normal through the part of its surface inside object
  /// 1. The rate at which the volume grows with object 2's motion is minus this.
  Vector3 push = Vector3::Zero();
  Vector3 turn = Vector3::Zero();  ///< m3: the same for rotations about object 1's origin
  double contact_area = 0;         ///< m2 of object 2's surface inside object 1
  std::uint64_t tested = 0;        ///< samples whose distance was evaluated
};

/// The volume that two `sparse` assets share, exact apart from the sampling. It works for any
/// shapes, by the divergence theorem over the closed boundary of the overlap, which consists of
/// object 2's surface inside object 1 and object 1's surface inside object 2: V = 1/3 of the
/// integral of x . N. (The paper's own form, which sees one plane of each object, is
/// penetration_volume.)
///
/// Each sample counts once, however many planes or tiles the assets have; a sample whose patch
/// crosses the other surface counts in part. Samples that the tree of spheres shows to be outside
/// are skipped. `pose2` takes object 2's frame to object 1's. The time is bounded by the number of
/// samples; allocates nothing.
[[nodiscard]] OverlapVolume overlap_volume(const SampledObject& object1,
                                           const SampledObject& object2,
                                           const Eigen::Isometry3d& pose2) noexcept;

/// Force and torque on object 2 from the potential E(V) = 1/2 stiffness V^2 (stiffness in N/m5),
/// torque about `about`; object 1's frame. The force points in the direction in which V shrinks
/// fastest.
[[nodiscard]] Wrench overlap_wrench(const OverlapVolume& overlap, double stiffness,
                                    const Vector3& about) noexcept;

}  // namespace spm
