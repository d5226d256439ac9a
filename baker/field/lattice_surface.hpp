// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <array>
#include <cstdint>
#include <memory>
#include <vector>

#include "baker/cast/cast.hpp"
#include "baker/field/corner_distances.hpp"
#include "baker/surface/outer_surface.hpp"
#include "common/field/feature_sides.hpp"

namespace spm::baker {

using LatticePoint = std::array<std::uint32_t, 3>;

/// A triangle as the file will store it.
struct LatticeTriangle {
  std::array<Vector3, 3> corners;  ///< m, on the lattice; the first side is the shortest
  TriangleShares shares;
  Vector3 normal = Vector3::Zero();     ///< unit; 0 where there is no area
  FeatureSides sides = 0;               ///< of places that are nearest to its sides and corners
  std::array<LatticePoint, 3> steps{};  ///< the corners, lattice steps from the origin
  bool sheet = false;
  bool thin = false;    ///< too thin for single precision
  bool folded = false;  ///< another lies on it and faces the other way

  /// At the corners of a cube.
  [[nodiscard]] CornerValues corner_distances(const Vector3& middle, double half) const {
    return baker::corner_distances(corners, shares, middle, half);
  }
  [[nodiscard]] CornerTangents corner_tangents(const Vector3& middle, double half) const {
    return baker::corner_tangents(corners, shares, middle, half);
  }
};

/// The outer surface with its corners rounded to one lattice, so that what shares a corner shares
/// it exactly. Slivers are gone (remove_slivers).
struct LatticeSurface {
  Vector3 origin = Vector3::Zero();
  double step = 1;                         ///< m, a power of two
  std::vector<LatticeTriangle> triangles;  ///< of solids, then of sheets
  OuterSurface surface;                    ///< the same triangles
  /// m: distances to this surface are those to the outer surface within this.
  double displacement = 0;
  double sheet_thickness = 0;      ///< m; 0 where there are no sheets
  std::unique_ptr<Caster> caster;  ///< over `surface`
  /// Where that does not close: the triangles of its OuterSurface::sides, for their crossings.
  std::vector<LatticeTriangle> crossed;

  /// The i-th of the triangles and, behind them, of those that are only crossed.
  [[nodiscard]] const LatticeTriangle& any_triangle(std::size_t i) const noexcept {
    return i < triangles.size() ? triangles[i] : crossed[i - triangles.size()];
  }
};

/// `caster` is over the surface. `tolerance` in metres: the displacement is kept to a small share
/// of it, as far as corner_bits allow.
[[nodiscard]] LatticeSurface round_to_lattice(const OuterSurface& surface, const Caster& caster,
                                              double tolerance);

}  // namespace spm::baker
