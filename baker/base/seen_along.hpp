// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <array>
#include <cstdint>
#include <memory>
#include <span>
#include <vector>

#include "common/base/vector.hpp"

namespace spm::baker {

/// Triangles by where they are seen along a way.
class SeenAlong {
 public:
  SeenAlong() = default;
  SeenAlong(const Vector3& way, std::span<const std::array<Vector3, 3>> triangles);

  /// The numbers of those that may lie on the line along the way through a point, in order.
  [[nodiscard]] std::vector<std::uint32_t> over(const Vector3& point) const;

 private:
  struct Tree;
  using OnPlane = std::array<double, 2>;
  /// Where a place is seen: on the plane across the axis.
  [[nodiscard]] OnPlane seen(const Vector3& p) const;

  Vector3 way_ = Vector3::UnitX();
  int axis_ = 0;  ///< the one that is closest to the way
  std::shared_ptr<const Tree> tree_;
};

}  // namespace spm::baker
