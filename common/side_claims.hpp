// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <limits>

#include "common/asset_view.hpp"

namespace spm {

/// What one surface says of a point: how far it is, on which side the point lies, and how much of
/// the distance is along the foot's own normal; m.
struct SideClaim {
  double distance = std::numeric_limits<double>::infinity();
  bool inside = false;
  double along_normal = 0;

  /// True where the foot lies in the surface and not on its border: its normal meets the point.
  [[nodiscard]] bool faces() const noexcept { return along_normal >= 0.95 * distance; }
};

/// Gathers the claims of a list's surfaces and tells the side. A surface that faces the point tells
/// it alone where it is the nearest. At a border the nearest foot says little: there the nearest of
/// those that face the point does, if it is no farther than a tie; else the one that faces it most.
class SideClaims {
 public:
  explicit SideClaims(double tie) noexcept : tie_(tie) {}

  void add(const SideClaim& claim) noexcept {
    if (claim.distance < nearest_.distance) nearest_ = claim;
    if (claim.faces()) {
      if (claim.distance < facing_.distance) facing_ = claim;
    } else if (most_.distance > nearest_.distance + tie_ ||
               (claim.distance <= nearest_.distance + tie_ &&
                claim.along_normal * most_.distance > most_.along_normal * claim.distance)) {
      most_ = claim;
    }
  }

  /// Claims farther than this can no longer change the answer, m.
  [[nodiscard]] double limit() const noexcept {
    return nearest_.faces() ? nearest_.distance : nearest_.distance + tie_;
  }
  [[nodiscard]] bool nearest_faces() const noexcept { return nearest_.faces(); }

  [[nodiscard]] bool inside() const noexcept {
    const double reach = nearest_.distance + tie_;
    if (facing_.distance <= reach) return facing_.inside;
    if (most_.distance <= reach) return most_.inside;
    return nearest_.inside;
  }

 private:
  double tie_;
  SideClaim nearest_, facing_, most_;
};

}  // namespace spm
