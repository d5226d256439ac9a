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

/// Where the centre of a ball can be that is outside the solid and came from outside the object:
/// on voxels, too many rather than too few.
class ReachField {
 public:
  /// `radius` in metres, above 0; corners of the object's box. With a workspace that no way from
  /// outside leads into, a ball is taken to start wherever it fits there. Uses all of oneTBB's
  /// threads; the same for any number of them.
  ReachField(const Caster& caster, const Vector3& low, const Vector3& high, double radius,
             const std::optional<OrientedBox>& workspace, const Progress& progress);

  /// Whether such a place may be within `distance` metres of a point.
  [[nodiscard]] bool near(const Vector3& point, double distance) const noexcept;

  /// Half the diagonal of a voxel, m: how far too much is taken for reached at most.
  [[nodiscard]] double coarseness() const noexcept;

  /// Voxels of a field of that radius about a box of that size, m: as fine as the radius asks, or
  /// as their number permits.
  [[nodiscard]] static double voxel_size(const Vector3& size, double radius) noexcept;

 private:
  using Index = std::array<std::int32_t, 3>;

  Vector3 origin_ = Vector3::Zero();
  double size_ = 1;
  Index cells_{};
  std::vector<std::uint8_t> state_;    ///< a Voxel each, x fastest; empty once built
  std::vector<std::uint32_t> square_;  ///< squared distance to a reached voxel, in voxels

  [[nodiscard]] std::size_t at(const Index& index) const noexcept;
  [[nodiscard]] Vector3 middle(const Index& index) const noexcept;
  void find_passable(const Caster& caster, double radius, const Progress& progress);
  void flood_from_outside();
  void flood_within(const OrientedBox& workspace);
  void flood(std::vector<std::uint32_t>& open);
  void measure_distances();
};

}  // namespace spm::baker
