// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <cstdint>
#include <limits>
#include <optional>

#include "common/contact/force_law.hpp"

namespace spm {

/// The penalty force as minus the gradient of one potential, U = k max(0, r - d)^2 / 2. r is the
/// probe's radius, and d is the field's signed distance, interpolated between the corners of a
/// cubic lattice in the asset's frame.
///
/// Why: where patches of a baked field meet, its distance jumps, and its normals do not show that.
/// Along a closed path their force may therefore give energy. An interpolant passes such a place
/// without a jump, and its own gradient is the direction of the force, as on a stored distance
/// field.
///
/// The interpolant is quadratic in each of the six tetrahedra about a cube's diagonal. Along an
/// edge it is the parabola through the distances of both corners, with the difference of slopes
/// that their normals have; this is the same from every tetrahedron at the edge. So only four
/// corners are evaluated, not ten, and between two tetrahedra the direction turns by hardly more
/// than the field does. (If it were linear in each, the direction would jump by the lattice's
/// spacing over the surface's radius.) On a plane it is the field itself.
///
/// Corners are evaluated when they are first needed, and cached. The cache is the only state: the
/// force depends on the position alone. No call allocates or throws.
class PotentialLattice {
 public:
  /// `spacing`: m, in the asset's frame; 0: off.
  explicit PotentialLattice(double spacing) noexcept : spacing_(spacing) {}

  [[nodiscard]] bool on() const noexcept { return spacing_ > 0; }

  /// Force for a probe centred at `point` (asset's frame, m), by the field or by the smoothed
  /// field; |force| = stiffness * depth. Nothing if the corners about the point are not all in the
  /// band, or the point is not finite: the field ends there, and a jump to unknown values must not
  /// push. One lattice reads one asset until `forget`.
  [[nodiscard]] std::optional<ContactForce> force(const AssetView& asset,
                                                  const ForceSettings& settings,
                                                  const RuntimeSmoothing& smoothing,
                                                  const Vector3& point) noexcept;

  /// Clears the cache: when the asset was exchanged.
  void forget() noexcept { corners_.fill({}); }

 private:
  /// Signed distance (m) and its gradient at a point.
  struct FieldValue {
    double distance = std::numeric_limits<double>::quiet_NaN();  ///< NaN: not in the band
    Vector3 gradient = Vector3::Zero();
  };
  using Place = std::array<std::int32_t, 3>;  ///< in spacings
  struct Corner {
    Place place{};
    bool is_asked = false;
    FieldValue value;
  };
  /// Corners that are cached along each axis, a power of two.
  static constexpr std::int32_t kept = 4;

  double spacing_;
  std::array<Corner, std::size_t{kept} * kept * kept> corners_;

  [[nodiscard]] static FieldValue field_at(const AssetView& asset,
                                           const RuntimeSmoothing& smoothing,
                                           const Vector3& point) noexcept;
  [[nodiscard]] const FieldValue& corner_at(const AssetView& asset,
                                            const RuntimeSmoothing& smoothing,
                                            const Place& place) noexcept;
  /// The value at a point given in spacings; NaN if a corner has no value.
  [[nodiscard]] FieldValue interpolated(const AssetView& asset, const RuntimeSmoothing& smoothing,
                                        const Vector3& at) noexcept;
};

}  // namespace spm
