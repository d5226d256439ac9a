// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <cstdint>
#include <limits>
#include <span>

#include "baker/base/cube_bins.hpp"
#include "common/asset/asset_view.hpp"

namespace spm::baker {

/// An axis-aligned box, m.
struct Box {
  Vector3 low = Vector3::Constant(std::numeric_limits<double>::infinity());
  Vector3 high = Vector3::Constant(-std::numeric_limits<double>::infinity());

  void include(const Vector3& point) {
    low = low.cwiseMin(point);
    high = high.cwiseMax(point);
  }
};

/// Tiles, listed by the cubes of space through which their valid surface passes.
class TileBins {
 public:
  /// Cubes of `edge` metres. A tile counts as `radius` metres thick.
  TileBins(std::span<const SupportPlane> planes, std::span<const Tile> tiles, float height_unit,
           double edge, double radius);

  /// Tiles whose surface may be within `radius` of a point.
  [[nodiscard]] std::span<const std::uint32_t> near(const Vector3& point) const;

 private:
  CubeGrid grid_;
  CubeBins bins_;
};

}  // namespace spm::baker
