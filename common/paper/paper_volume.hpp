// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <Eigen/Geometry>
#include <cstddef>
#include <cstdint>

#include "common/asset/asset_view.hpp"
#include "common/base/wrench.hpp"

namespace spm {

/// Which area a sample of S_2 stands for on S_1.
enum class AreaFactor : std::uint8_t {
  /// cos(n_1 n_2), to the letter of eq. 14 and 15: right only where the surface of M_2 lies along
  /// its support plane. (n_1 and n_2 look at each other; the cosine is taken positive.)
  paper,
  /// The projection of M_2's own surface, whose tilt against its plane counts as well:
  /// exact, and signed, so that surface of M_2 which looks the other way takes off what lies
  /// behind.
  surface,
};

/// Where two objects overlap, as far as one plane of each tells; object 1's frame.
struct PenetrationVolume {
  double mass = 0;                   ///< V, kg with a density in kg/m3: eq. 12 by way of 15
  double volume = 0;                 ///< m3
  Vector3 centre = Vector3::Zero();  ///< of gravity, m; zero where there is no volume
  Vector3 normal = Vector3::Zero();  ///< mean unit normal of M_1 there, n_S weighted by volume
  std::size_t samples = 0;           ///< cells of S_2 where f is positive: C_2
};

/// f of eq. 13 for a point W_2 of M_2's surface (object 1's frame, m): D_1(W_2) - D_1(M_1), how far
/// W_2 lies under M_1 along the normal of S_1, plane `plane` of object 1 (a `full` asset), by layer
/// 0 of its map; NaN where that does not reach.
[[nodiscard]] double penetration_function(const AssetView& object1, std::size_t plane,
                                          const Vector3& point) noexcept;

/// The volume that two `full` assets share, by plane `plane1` of the one and `plane2` of the other:
/// the sum of eq. 15 over the cells of S_2, the middle of each of which reconstructs a point W_2 of
/// M_2 (eq. 4). `pose2` takes object 2's frame to object 1's; `density` in kg/m3.
[[nodiscard]] PenetrationVolume penetration_volume(const AssetView& object1, std::size_t plane1,
                                                   const AssetView& object2, std::size_t plane2,
                                                   const Eigen::Isometry3d& pose2, double density,
                                                   AreaFactor factor) noexcept;

/// The single force of section 3.3 on object 2, applied at the volume's centre of gravity:
/// `stiffness` (N/m3) times the volume, along M_1's normal there; torque about `about` (object 1's
/// frame, m).
[[nodiscard]] Wrench volume_wrench(const PenetrationVolume& volume, double stiffness,
                                   const Vector3& about) noexcept;

}  // namespace spm
