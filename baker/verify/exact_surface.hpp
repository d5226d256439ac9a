// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <cstddef>
#include <memory>

#include "baker/mesh/mesh.hpp"
#include "common/base/vector.hpp"

namespace spm::baker {

/// A point of the outer surface and the outward normal of the triangle it lies on.
struct SurfacePoint {
  Vector3 position = Vector3::Zero();
  Vector3 normal = Vector3::Zero();  ///< of a sheet either of its normals
  std::size_t triangle = 0;          ///< of the outer surface
  bool sheet = false;                ///< of a sheet, and not of a solid
};

inline constexpr double narrow_share = 0.02;

/// The features of a surface that compete for being the closest.
struct Rivals {
  bool contested = false;  ///< one differs from the closest by more than 5 degrees
  double angle = 0;        ///< rad, from the direction asked about to the nearest of theirs
};

/// The reference against which assets are measured: the lesser of the signed distance to the
/// boundary of the union of a mesh's solids and of the distance to the sheets outside less their
/// half-thickness, exact up to rounding (SOLID.md). It shares no code with the fit. Immutable; any
/// number of threads may use it.
class ExactSurface {
 public:
  /// `sheet_thickness`, m: from the middle of a sheet to what is felt of it. `tolerance`, m, of
  /// what is judged: gaps narrower than narrow_share of it are closed (SOLID.md).
  explicit ExactSurface(const Mesh& mesh, double sheet_thickness = 0, double tolerance = 0);
  ~ExactSurface();
  ExactSurface(const ExactSurface&) = delete;
  ExactSurface& operator=(const ExactSurface&) = delete;

  [[nodiscard]] bool empty() const noexcept;          ///< nothing is felt
  [[nodiscard]] double area() const noexcept;         ///< m2
  [[nodiscard]] double hidden_area() const noexcept;  ///< m2, of the mesh, inside other parts
  [[nodiscard]] bool has_gaps() const noexcept;       ///< that are closed; they may be of width 0

  /// Whether a point is in a solid: its winding number is above one half, or it lies in a gap that
  /// is closed.
  [[nodiscard]] bool inside(const Vector3& point) const;

  /// The point of the outer surface whose distance counts.
  [[nodiscard]] SurfacePoint closest(const Vector3& point) const;
  /// The same; sooner found from a point of the surface that is not far off.
  [[nodiscard]] SurfacePoint closest(const Vector3& point, const SurfacePoint& from) const;

  /// The signed distance of a point, m, and its size, which is sooner found, by that closest point.
  [[nodiscard]] double distance(const Vector3& point, const SurfacePoint& closest) const;
  [[nodiscard]] double size_of_distance(const Vector3& point, const SurfacePoint& closest) const;

  /// A point of the surface, uniform by area for `choice`, `a` and `b` uniform in [0, 1).
  [[nodiscard]] SurfacePoint at(double choice, double a, double b) const;

  /// True where another feature of the surface is at most `window` metres farther away, in a
  /// direction that differs by more than 5 degrees from that of `closest`. That close to the medial
  /// axis, the closest feature and so the direction are arbitrary.
  [[nodiscard]] bool contested(const Vector3& point, const SurfacePoint& closest,
                               double window) const;

  /// The same, and how far `direction`, from the point towards the surface, is from the nearest of
  /// those features' directions.
  [[nodiscard]] Rivals rivals(const Vector3& point, const SurfacePoint& closest, double window,
                              const Vector3& direction) const;

 private:
  struct Implementation;
  std::unique_ptr<Implementation> implementation_;
};

}  // namespace spm::baker
