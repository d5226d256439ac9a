// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <array>
#include <optional>
#include <span>
#include <vector>

#include "baker/base/seen_along.hpp"
#include "baker/mesh/mesh.hpp"
#include "baker/mesh/winding_number.hpp"

namespace spm::baker {

/// Winding number of solids by their boundary, which gaps of some um may leave open: by what a line
/// through a place crosses, on exact predicates. Where that does not tell, by angles.
class SolidSide {
 public:
  /// Copies what it needs.
  SolidSide(std::span<const Vector3> vertices, std::span<const Triangle> triangles);

  /// On the surface it takes the value of one of its sides. Thread-safe and deterministic.
  [[nodiscard]] int winding(const Vector3& point) const;

 private:
  [[nodiscard]] std::optional<int> crossings(const Vector3& point) const;

  WindingNumber angles_;
  std::vector<std::array<Vector3, 3>> corners_;
  double diagonal_ = 0;
  Vector3 way_;
  SeenAlong seen_;
};

}  // namespace spm::baker
