// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <cstddef>

#include "common/base/vector.hpp"

namespace spm {

/// Up to four points of a convex set, and the point of their hull that is nearest to the origin:
/// the state of the iteration of Gilbert, Johnson and Keerthi (1988).
class NearestSimplex {
 public:
  explicit NearestSimplex(const Vector3& first) noexcept : nearest_(first) { points_[0] = first; }

  [[nodiscard]] const Vector3& nearest() const noexcept { return nearest_; }
  /// True where the points surround the origin.
  [[nodiscard]] bool around_origin() const noexcept { return around_; }

  /// Adds a point. Where there would be five, it drops one that the nearest point does not need.
  /// False where the new point brings the hull no nearer.
  bool add(const Vector3& point) noexcept;

 private:
  std::array<Vector3, 4> points_{};
  std::size_t count_ = 1;
  Vector3 nearest_;
  bool around_ = false;

  bool add_fourth(const Vector3& point) noexcept;
};

/// Result of hull_distance for a convex set.
struct HullDistance {
  Vector3 direction = Vector3::UnitX();  ///< unit, from the origin towards the set
  double lower_bound = 0;  ///< m: lower bound of its distance; 0: it may contain the origin
};

/// Distance from the origin to a convex set. `support(v)` gives the point of the set that is
/// farthest along v; it is called at most `steps` times, and once before. Ends as soon as the set
/// is known to be farther away than `enough` (m), or to contain the origin.
template <class Support>
[[nodiscard]] HullDistance hull_distance(const Support& support, const Vector3& first_direction,
                                         double enough, int steps) noexcept {
  HullDistance found;
  NearestSimplex simplex(support(-first_direction));
  for (int step = 0; step < steps; ++step) {
    const double length = simplex.nearest().norm();
    if (!(length > 0) || simplex.around_origin()) return {found.direction, 0};
    const Vector3 towards = simplex.nearest() / length;
    const Vector3 point = support(-towards);
    const double least = towards.dot(point);
    if (least > found.lower_bound) found = {towards, least};
    if (found.lower_bound > enough || length - least <= 1e-9 * length || !simplex.add(point)) break;
  }
  return found;
}

}  // namespace spm
