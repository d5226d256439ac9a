// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <algorithm>
#include <cmath>
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
/// What shares an edge is no farther apart than the surfaces are off: so a claim is worth the less
/// the more its normal looks past the point, and the farther it is, in ties. (How the sine counts
/// was chosen by trials: with its power 1.5 the fewest answers were wrong.)
class SideClaims {
 public:
  /// `tie`: how much farther a claim must be for what it says to be worth nothing, m, above 0.
  explicit SideClaims(double tie) noexcept : tie_(tie) {}

  void add(const SideClaim& claim) noexcept {
    const double faces = claim.distance > 0 ? claim.along_normal / claim.distance : 1;
    const double sine = std::sqrt(std::max(1 - faces * faces, 0.0));
    const double worth = 1 - sine * std::sqrt(sine) - claim.distance / tie_;
    double& best = claim.inside ? inside_worth_ : outside_worth_;
    best = std::max(best, worth);
  }

  /// Claims farther than this can no longer change the answer, nor a margin below `margin`, m.
  [[nodiscard]] double limit(double margin = 0) const noexcept {
    return tie_ * (1 + margin - std::max(inside_worth_, outside_worth_));
  }
  [[nodiscard]] bool inside() const noexcept { return inside_worth_ > outside_worth_; }
  /// How clear the answer is: the difference of what the two sides are worth, of those claims that
  /// were added.
  [[nodiscard]] double margin() const noexcept { return std::abs(inside_worth_ - outside_worth_); }

 private:
  double tie_;
  double inside_worth_ = -std::numeric_limits<double>::infinity();
  double outside_worth_ = -std::numeric_limits<double>::infinity();
};

}  // namespace spm
