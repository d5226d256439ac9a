// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>

#include "common/base/vector.hpp"
#include "common/query/triangle_side.hpp"

namespace spm {

/// The vote of one surface on a point: its distance, the side on which the point lies, and the
/// component of the distance along the normal at the closest point; m.
struct SideVote {
  double distance = std::numeric_limits<double>::infinity();
  bool inside = false;
  double along_normal = 0;
};

/// Gathers the votes of surfaces and decides the side of a point.
///
/// The normal at a closest point in the interior of a surface passes through the point; the nearest
/// such closest point decides. A closest point on a border or an edge faces the point less, and its
/// vote is weak; of those that share an edge, the one that faces the point most decides. Surfaces
/// that share an edge are no farther apart than their error. So a vote weighs less the more its
/// normal points past the point, and, in ties, the farther away it is. (How the sine counts was
/// chosen by experiment: the power 1.5 gave the fewest wrong answers.)
///
/// Triangles are the surface itself, and decide the side among themselves (TriangleSide): of their
/// votes only those for that side count.
class SideVotes {
 public:
  /// `tie`: how much farther away a vote must be for its weight to vanish. `rounding`: how far
  /// apart closest points on triangles may be and still be the same but for rounding. m, above 0.
  SideVotes(double tie, double rounding) noexcept : tie_(tie), triangles_(rounding) {}

  /// Adds the vote of a fitted surface.
  void add(const SideVote& vote) noexcept {
    double& best = vote.inside ? fitted_.inside : fitted_.outside;
    best = std::max(best, weight(vote));
  }

  /// Adds the vote of a triangle with these corners and this closest point.
  void add_exact(const SideVote& vote, const std::array<Vector3, 3>& corners,
                 const Vector3& closest_point) noexcept {
    double& best = vote.inside ? exact_.inside : exact_.outside;
    best = std::max(best, weight(vote));
    triangles_.add(corners, closest_point, vote.distance,
                   vote.inside ? -vote.along_normal : vote.along_normal);
  }

  /// Votes farther away than this, m, can no longer change the answer, nor a margin below `margin`.
  [[nodiscard]] double limit(double margin = 0) const noexcept {
    return tie_ * (1 + margin - std::max(of_inside(), of_outside()));
  }
  [[nodiscard]] bool inside() const noexcept { return of_inside() > of_outside() + even; }
  /// How clear the answer is: the difference of the weights of the two sides, over the votes added.
  [[nodiscard]] double margin() const noexcept { return std::abs(of_inside() - of_outside()); }

 private:
  /// Two sheets in one place vote for both sides, and are outside more often than inside.
  static constexpr double even = 1e-9;
  struct Weights {
    double inside = -std::numeric_limits<double>::infinity();
    double outside = -std::numeric_limits<double>::infinity();
  };
  double tie_;
  Weights fitted_, exact_;
  TriangleSide triangles_;

  [[nodiscard]] double weight(const SideVote& vote) const noexcept {
    const double faces = vote.distance > 0 ? vote.along_normal / vote.distance : 1;
    const double sine = std::sqrt(std::max(1 - faces * faces, 0.0));
    return 1 - sine * std::sqrt(sine) - vote.distance / tie_;
  }
  [[nodiscard]] double of_inside() const noexcept {
    return triangles_.side() > 0 ? fitted_.inside : std::max(fitted_.inside, exact_.inside);
  }
  [[nodiscard]] double of_outside() const noexcept {
    return triangles_.side() < 0 ? fitted_.outside : std::max(fitted_.outside, exact_.outside);
  }
};

}  // namespace spm
