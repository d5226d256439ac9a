// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <cstdint>
#include <limits>
#include <optional>

#include "common/contact/force_law.hpp"

namespace spm {

/// The penalty force as minus the gradient of one potential, U = k max(0, r - d)^2 / 2, r being the
/// probe's radius and d the field's signed distance, interpolated between the corners of a cubic
/// lattice in the asset's frame. Where patches of a baked field meet, its distance jumps and its
/// normals do not tell: along a closed path their force may give energy. An interpolant goes
/// through such a place without a jump, and its own gradient is the force's direction, as on a
/// stored distance field. It is quadratic in each of the six tetrahedra about a cube's diagonal:
/// along an edge the parabola through both corners' distances whose slopes differ as their normals
/// do, which is the same from every tetrahedron about it. So four corners are asked and not ten,
/// and between two tetrahedra the direction turns by hardly more than the field does (linear in
/// each, it would jump by the lattice's spacing over the surface's radius). On a plane it is the
/// field itself. Corners are asked when they are first needed and remembered, which is all that it
/// remembers: the force depends on the place alone. Nothing in it allocates or throws.
class PotentialLattice {
 public:
  /// `spacing`: m, of the asset's frame; 0: off.
  explicit PotentialLattice(double spacing) noexcept : spacing_(spacing) {}

  [[nodiscard]] bool on() const noexcept { return spacing_ > 0; }

  /// Force for a probe centred at `point` (asset's frame, m), of the field or of the smoothed one;
  /// |force| = stiffness * depth. Nothing where the corners about the point are not all in the
  /// band, or it is no place: there the field ends, and no jump to what is not known may push. One
  /// lattice reads one asset until `forget`.
  [[nodiscard]] std::optional<ContactForce> force(const AssetView& asset,
                                                  const ForceSettings& settings,
                                                  const RuntimeSmoothing& smoothing,
                                                  const Vector3& point) noexcept;

  /// Forgets all: when the asset was exchanged.
  void forget() noexcept { corners_.fill({}); }

 private:
  /// Signed distance (m) and its gradient at a place.
  struct FieldValue {
    double distance = std::numeric_limits<double>::quiet_NaN();  ///< no number: not in the band
    Vector3 gradient = Vector3::Zero();
  };
  using Place = std::array<std::int32_t, 3>;  ///< in spacings
  struct Corner {
    Place place{};
    bool is_asked = false;
    FieldValue value;
  };
  /// Corners that are remembered along each axis, a power of two.
  static constexpr std::int32_t kept = 4;

  double spacing_;
  std::array<Corner, std::size_t{kept} * kept * kept> corners_;

  [[nodiscard]] static FieldValue field_at(const AssetView& asset,
                                           const RuntimeSmoothing& smoothing,
                                           const Vector3& point) noexcept;
  [[nodiscard]] const FieldValue& corner_at(const AssetView& asset,
                                            const RuntimeSmoothing& smoothing,
                                            const Place& place) noexcept;
  /// At a place in spacings; no numbers where a corner has none.
  [[nodiscard]] FieldValue interpolated(const AssetView& asset, const RuntimeSmoothing& smoothing,
                                        const Vector3& at) noexcept;
};

}  // namespace spm
