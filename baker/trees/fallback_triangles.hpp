// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <array>

#include "baker/cast/cast.hpp"
#include "baker/trees/triangle_fans.hpp"
#include "formats/asset/asset.hpp"

namespace spm::baker {

/// How the fallback of a `sparse` asset stores its triangles: with 16 bits a coordinate where the
/// tolerance allows it, otherwise as floats.
class FallbackTriangles {
 public:
  FallbackTriangles(const Caster& caster, double tolerance);

  /// How far the rounding of triangles may move them, m. The proof leaves that much room.
  [[nodiscard]] static double rounding(double tolerance);

  /// Corners as the file gives them back.
  [[nodiscard]] std::array<Vector3, 3> stored(const std::array<Vector3, 3>& corners) const;
  /// True where rounding left a triangle without a direction. Such a triangle is left out, since
  /// its neighbours are as near.
  [[nodiscard]] bool lost(const std::array<Vector3, 3>& corners) const;

  /// Sets the origin and step of the stored numbers.
  void describe(Asset& asset) const;
  /// Appends the corners of a fan to an asset.
  void append(const TriangleFan& fan, Asset& asset) const;

 private:
  Vector3 origin_ = Vector3::Zero();
  double step_ = 0;  ///< 0 where stored as floats

  [[nodiscard]] std::uint16_t steps(const Vector3& corner, int axis) const;
};

}  // namespace spm::baker
