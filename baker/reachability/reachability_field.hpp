// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <array>
#include <cstdint>
#include <optional>
#include <vector>

#include "baker/base/oriented_box.hpp"
#include "baker/base/progress.hpp"
#include "baker/cast/cast.hpp"

namespace spm::baker {

/// Where the centre of a ball can be, if the ball is outside the solid and came from outside the
/// object. On voxels; in doubt a voxel counts as reachable.
class ReachabilityField {
 public:
  /// `radius` in metres, above 0; `low` and `high` are corners of the object's box. Where no way
  /// from outside leads into the workspace, the ball starts wherever it fits there. Uses all
  /// threads of oneTBB. The result is the same for any number of them.
  ReachabilityField(const Caster& caster, const Vector3& low, const Vector3& high, double radius,
                    const std::optional<OrientedBox>& workspace, const Progress& progress);

  /// Whether a place that the centre can come to may be within `distance` metres of a point.
  [[nodiscard]] bool near(const Vector3& point, double distance) const noexcept;

  /// Half the diagonal of a voxel, m: by at most this too much counts as reachable.
  [[nodiscard]] double coarseness() const noexcept;

  /// Edge of the voxels for that radius and a box of that size, m: as fine as the radius needs, or
  /// as the allowed number of voxels permits.
  [[nodiscard]] static double voxel_size(const Vector3& size, double radius) noexcept;

 private:
  using Index = std::array<std::int32_t, 3>;

  Vector3 origin_ = Vector3::Zero();
  double size_ = 1;
  Index cells_{};
  std::vector<std::uint8_t> state_;    ///< one Voxel each, x fastest; empty once built
  std::vector<std::uint32_t> square_;  ///< squared distance to a reachable voxel, in voxels

  [[nodiscard]] std::size_t at(const Index& index) const noexcept;
  [[nodiscard]] Vector3 middle(const Index& index) const noexcept;
  void find_passable(const Caster& caster, double radius, const Progress& progress);
  void flood_from_outside();
  void flood_within(const OrientedBox& workspace);
  void flood(std::vector<std::uint32_t>& open);
  void measure_distances();
};

}  // namespace spm::baker
