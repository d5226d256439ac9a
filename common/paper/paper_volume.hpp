// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <Eigen/Geometry>
#include <cstddef>
#include <cstdint>

#include "common/asset/asset_view.hpp"
#include "common/base/wrench.hpp"

namespace spm {

/// Which area of S_1 a sample of S_2 represents.
enum class AreaFactor : std::uint8_t {
  /// cos(n_1 n_2), to the letter of eq. 14 and 15. Right only where the surface of M_2 is parallel
  /// to its support plane. (n_1 and n_2 point towards each other; the cosine is taken as positive.)
  paper,
  /// The projection of M_2's own surface, including its tilt against its plane. Exact and signed:
  /// surface of M_2 that faces the other way subtracts what lies behind it.
  surface,
};

/// The overlap of two objects as one plane of each sees it; object 1's frame.
struct PenetrationVolume {
  double mass = 0;                   ///< V, kg for a density in kg/m3: eq. 12, computed by eq. 15
  double volume = 0;                 ///< m3
  double area = 0;                   ///< of S_1, m2: C_1, on which the volume stands
  Vector3 centre = Vector3::Zero();  ///< centre of gravity, m; zero where there is no volume
  Vector3 normal = Vector3::Zero();  ///< mean unit normal of M_1 there: n_S weighted by volume
  std::size_t samples = 0;           ///< cells of S_2 where f is positive: C_2
};

/// f of eq. 13 for a point W_2 of M_2's surface (object 1's frame, m): D_1(W_2) - D_1(M_1). This is
/// how far W_2 lies under M_1 along the normal of S_1, which is plane `plane` of object 1 (a `full`
/// asset), by layer 0 of its map. Beside an edge of M_1 its nearest sample counts; where that met
/// nothing f is below every number, and outside the map it is NaN.
[[nodiscard]] double penetration_function(const AssetView& object1, std::size_t plane,
                                          const Vector3& point) noexcept;

/// The volume that two `full` assets share, seen by plane `plane1` of object 1 and `plane2` of
/// object 2: eq. 12 in the form of eq. 14, an integral over S_2, evaluated as the sum of eq. 15
/// over the cells of S_2. The middle of each cell gives a point W_2 of M_2 (eq. 4); beside an edge
/// of M_2 it is the middle of those of the cell's samples that met M_2, which count a quarter each.
/// `pose2` takes object 2's frame to object 1's; `density` in kg/m3. With `stride` every so many-th
/// sample of S_2 in both directions makes the corners of the cells, which are larger then, so that
/// areas stay right. It must be 1 or more.
[[nodiscard]] PenetrationVolume penetration_volume(const AssetView& object1, std::size_t plane1,
                                                   const AssetView& object2, std::size_t plane2,
                                                   const Eigen::Isometry3d& pose2, double density,
                                                   AreaFactor factor,
                                                   std::uint32_t stride = 1) noexcept;

/// The cells of a map that penetration_volume looks at with a stride.
[[nodiscard]] constexpr std::uint32_t strided_cells(std::uint32_t columns, std::uint32_t rows,
                                                    std::uint32_t stride) noexcept {
  return ((columns - 2) / stride + 1) * ((rows - 2) / stride + 1);
}

/// The single force of section 3.3 on object 2, applied at the centre of gravity of the volume:
/// `stiffness` (N/m3) times the volume, along M_1's normal there. Torque about `about` (object 1's
/// frame, m).
[[nodiscard]] Wrench volume_wrench(const PenetrationVolume& volume, double stiffness,
                                   const Vector3& about) noexcept;

}  // namespace spm
