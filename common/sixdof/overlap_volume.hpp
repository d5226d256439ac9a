// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <Eigen/Geometry>
#include <cstdint>

#include "common/asset/asset_view.hpp"
#include "common/sixdof/surface_samples.hpp"
#include "common/base/wrench.hpp"

namespace spm {

/// An object as overlap_volume needs it: its baked field and samples of its surface.
struct SampledObject {
  const AssetView* field = nullptr;
  const SurfaceSamples* samples = nullptr;
};

/// Where two objects overlap; object 1's frame.
struct OverlapVolume {
  double volume = 0;                 ///< m3: eq. 12 with a density of 1
  Vector3 centre = Vector3::Zero();  ///< of gravity, m; zero where there is no volume
  /// m2: the flux of the outward normal of object 2 through its surface inside object 1, turned
  /// round: how fast the volume grows with object 2's motion is minus this.
  Vector3 push = Vector3::Zero();
  Vector3 turn = Vector3::Zero();  ///< m3: the same for turns about object 1's origin
  double contact_area = 0;         ///< m2 of object 2's surface inside object 1
  std::uint64_t tested = 0;        ///< samples whose distance was asked for
};

/// The volume that two `sparse` assets share, exactly but for the sampling: by the divergence
/// theorem over the whole boundary of the overlap, which is object 2's surface inside object 1 and
/// object 1's inside object 2: V = 1/3 of the integral of x . N (eq. 12, for any shapes and all
/// planes at once, where eq. 15 sees one plane of each). Samples count once, however many planes or
/// tiles the assets have; one whose patch lies across the other surface counts in part. Samples
/// that the tree of spheres shows to be outside are passed over. `pose2` takes object 2's frame to
/// object 1's. Bounded by the number of samples; allocates nothing.
[[nodiscard]] OverlapVolume overlap_volume(const SampledObject& object1,
                                           const SampledObject& object2,
                                           const Eigen::Isometry3d& pose2) noexcept;

/// Force and torque on object 2 of the potential E(V) = 1/2 stiffness V^2 (stiffness in N/m5),
/// torque about `about`; object 1's frame. Its direction is that in which V shrinks fastest.
[[nodiscard]] Wrench overlap_wrench(const OverlapVolume& overlap, double stiffness,
                                    const Vector3& about) noexcept;

}  // namespace spm
