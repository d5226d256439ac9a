// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <limits>

namespace spm {

/// What one surface says of a point: how far it is, on which side the point lies, and how much of
/// the distance is along the foot's own normal; m.
struct SideClaim {
  double distance = std::numeric_limits<double>::infinity();
  bool inside = false;
  double along_normal = 0;
};

/// Gathers the claims of surfaces and tells the side. A foot within a surface faces the point: its
/// normal meets it, and the nearest such foot tells the side. A foot on a border or an edge faces
/// it less, and says little; of those that share an edge the one that faces the point most tells.
/// What shares an edge is no farther apart than the surfaces are off: so a claim is worth the
/// cosine at which it faces the point, less its distance in ties.
class SideClaims {
 public:
  /// `tie`: how much farther a claim must be for what it says to be worth nothing, m, above 0.
  explicit SideClaims(double tie) noexcept : tie_(tie) {}

  void add(const SideClaim& claim) noexcept {
    const double faces = claim.distance > 0 ? claim.along_normal / claim.distance : 1;
    const double worth = faces - claim.distance / tie_;
    if (!(worth > worth_)) return;
    worth_ = worth;
    inside_ = claim.inside;
  }

  /// Claims farther than this can no longer change the answer, m.
  [[nodiscard]] double limit() const noexcept { return tie_ * (1 - worth_); }
  [[nodiscard]] bool inside() const noexcept { return inside_; }

 private:
  double tie_;
  double worth_ = -std::numeric_limits<double>::infinity();
  bool inside_ = false;
};

}  // namespace spm
