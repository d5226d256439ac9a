// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <array>
#include <cstdint>
#include <span>
#include <vector>

#include "baker/base/cube_bins.hpp"
#include "common/base/vector.hpp"

namespace spm::baker {

/// Triangles by the cells of a plane that they lie over, seen along a way.
class SeenAlong {
 public:
  SeenAlong() = default;
  SeenAlong(const Vector3& way, std::span<const std::array<Vector3, 3>> triangles);

  /// The numbers of those that may lie on the line along the way through a point, in order.
  [[nodiscard]] std::span<const std::uint32_t> over(const Vector3& point) const;

 private:
  [[nodiscard]] Vector3 seen(const Vector3& p) const;
  void list(const std::array<Vector3, 3>& triangle, std::uint32_t number,
            std::vector<CubeBins::Member>& members) const;

  Vector3 way_ = Vector3::UnitX();
  int axis_ = 0;  ///< the one that is closest to the way
  CubeGrid cells_;
  CubeBins over_;
};

}  // namespace spm::baker
