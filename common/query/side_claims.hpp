// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>

#include "common/query/triangle_side.hpp"
#include "common/base/vector.hpp"

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
///
/// Triangles are the surface itself, and tell the side among themselves (TriangleSide): only the
/// claims of those count that are for that side.
class SideClaims {
 public:
  /// `tie`: how much farther a claim must be for what it says to be worth nothing; `rounding`: how
  /// far apart feet of triangles may be and be the same but for rounding; m, above 0.
  SideClaims(double tie, double rounding) noexcept : tie_(tie), triangles_(rounding) {}

  /// Adds what a fitted surface says.
  void add(const SideClaim& claim) noexcept {
    double& best = claim.inside ? fitted_.inside : fitted_.outside;
    best = std::max(best, worth(claim));
  }

  /// Adds what a triangle says that has these corners and this foot.
  void add_exact(const SideClaim& claim, const std::array<Vector3, 3>& corners,
                 const Vector3& foot) noexcept {
    double& best = claim.inside ? exact_.inside : exact_.outside;
    best = std::max(best, worth(claim));
    triangles_.add(corners, foot, claim.distance,
                   claim.inside ? -claim.along_normal : claim.along_normal);
  }

  /// Claims farther than this can no longer change the answer, nor a margin below `margin`, m.
  [[nodiscard]] double limit(double margin = 0) const noexcept {
    return tie_ * (1 + margin - std::max(of_inside(), of_outside()));
  }
  [[nodiscard]] bool inside() const noexcept { return of_inside() > of_outside() + even; }
  /// How clear the answer is: the difference of what the two sides are worth, of those claims that
  /// were added.
  [[nodiscard]] double margin() const noexcept { return std::abs(of_inside() - of_outside()); }

 private:
  /// Two sheets in one place say both, and lie outside more often than within.
  static constexpr double even = 1e-9;
  struct Worth {
    double inside = -std::numeric_limits<double>::infinity();
    double outside = -std::numeric_limits<double>::infinity();
  };
  double tie_;
  Worth fitted_, exact_;
  TriangleSide triangles_;

  [[nodiscard]] double worth(const SideClaim& claim) const noexcept {
    const double faces = claim.distance > 0 ? claim.along_normal / claim.distance : 1;
    const double sine = std::sqrt(std::max(1 - faces * faces, 0.0));
    return 1 - sine * std::sqrt(sine) - claim.distance / tie_;
  }
  [[nodiscard]] double of_inside() const noexcept {
    return triangles_.side() > 0 ? fitted_.inside : std::max(fitted_.inside, exact_.inside);
  }
  [[nodiscard]] double of_outside() const noexcept {
    return triangles_.side() < 0 ? fitted_.outside : std::max(fitted_.outside, exact_.outside);
  }
};

}  // namespace spm
