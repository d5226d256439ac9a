// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <cstdint>
#include <limits>
#include <memory>
#include <optional>
#include <vector>

#include "baker/surface/outer_surface.hpp"
#include "common/surface/support_plane.hpp"

namespace spm::baker {

/// Where a ray meets the surface: distance from its plane, metres, double precision.
struct Crossing {
  double depth = 0;
  std::uint32_t triangle = 0;
  bool entry = false;  ///< into the solid; otherwise out of it
};

/// All crossings of one ray, in order. The column is consistent where entries and exits alternate,
/// with an entry first and an exit last. On a closed surface they always do.
struct Column {
  std::vector<Crossing> crossings;
  bool consistent = true;
};

/// The closest point of the surface, and the side on which the asked point lies.
struct ClosestPoint {
  /// m, signed, negative inside; of a sheet that from its middle less its half-thickness.
  double distance = 0;
  Vector3 closest_point = Vector3::Zero();
  Vector3 direction = Vector3::UnitZ();  ///< unit, outward: gradient of the signed distance
  std::uint32_t triangle = 0;
  /// m, the signed distance to the solids alone, within which the side is the same; only a bound
  /// from below where a sheet is nearer by more than its half-thickness, and infinite without
  /// solids.
  double solid = 0;
};

/// Rays through the solids and closest points on an outer surface. Embree finds the triangle in
/// single precision. Hits and distances are computed again in doubles, so that the result is the
/// same on every CPU. Any number of threads may use one caster.
class Caster {
 public:
  /// `sheet_thickness`, m: from the middle of a sheet to what is felt of it.
  explicit Caster(const OuterSurface& surface, double sheet_thickness = 0);
  ~Caster();
  Caster(const Caster&) = delete;
  Caster& operator=(const Caster&) = delete;

  /// ICD of eq. 2 with all sections of the ray (vectorial, Fig. 2): the crossings along -n from the
  /// plane's point at (eta, omega). A ray whose crossings do not alternate is cast again up to
  /// three times, displaced by less than a millionth of the object. If that does not help, it stays
  /// marked as inconsistent.
  void cast(const SupportPlane& plane, double eta, double omega, Column& column) const;

  /// The first crossing of the same ray between two depths below the plane, an entry or an exit.
  /// Empty where there is none.
  [[nodiscard]] std::optional<Crossing> first_between(const SupportPlane& plane, double eta,
                                                      double omega, double from, double to) const;

  /// The closest point of the surface. Found sooner where some of it is known to lie `within`, m.
  [[nodiscard]] ClosestPoint closest(const Vector3& point,
                                     double within = std::numeric_limits<double>::infinity()) const;

  /// The winding number of what tells the side: of the solids' triangles, or of
  /// OuterSurface::sides.
  [[nodiscard]] int winding(const Vector3& point) const;
  /// Whether that is at least 1.
  [[nodiscard]] bool is_inside(const Vector3& point) const;
  /// The same, or the point is in a gap between parts. It is `away` from the solids, m.
  [[nodiscard]] bool surrounds(const Vector3& point, double away) const;
  /// Over OuterSurface::sides, where there are some.
  [[nodiscard]] const Caster* whole() const;

  /// Triangles that have a point within `radius` metres of `point`, in ascending order.
  void within(const Vector3& point, double radius, std::vector<std::uint32_t>& triangles) const;
  /// The same and others whose boxes do, which are found sooner.
  void boxes_within(const Vector3& point, double radius,
                    std::vector<std::uint32_t>& triangles) const;

  /// A corner of a triangle, and a triangle's unit normal.
  [[nodiscard]] const Vector3& corner(std::uint32_t triangle, int which) const;
  [[nodiscard]] const Vector3& normal(std::uint32_t triangle) const;
  [[nodiscard]] double area(std::uint32_t triangle) const;  ///< m^2
  [[nodiscard]] bool is_sheet(std::uint32_t triangle) const;
  [[nodiscard]] std::size_t solid_count() const;     ///< triangles of solids, the first
  [[nodiscard]] std::size_t triangle_count() const;  ///< with sheets
  [[nodiscard]] double sheet_thickness() const;      ///< m; 0 where there are no sheets
  [[nodiscard]] double diagonal() const;

 private:
  struct Implementation;
  std::unique_ptr<Implementation> implementation_;
};

}  // namespace spm::baker
