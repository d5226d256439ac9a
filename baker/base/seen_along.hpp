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
  using Corners = std::array<Vector3, 3>;
  /// The cells of a box, and by cell what lies over it, or the level that divides it further.
  struct Level {
    CubeGrid cells;
    CubeBins over;
    std::vector<std::uint32_t> finer;  ///< 0 for none
  };

  [[nodiscard]] Vector3 seen(const Vector3& p) const;
  std::uint32_t add_level(const Vector3& low, const Vector3& size,
                          std::span<const Corners> triangles,
                          std::span<const std::uint32_t> numbers, int depth);

  Vector3 way_ = Vector3::UnitX();
  int axis_ = 0;  ///< the one that is closest to the way
  std::vector<Level> levels_;
};

}  // namespace spm::baker
