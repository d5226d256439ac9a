// SPDX-License-Identifier: GPL-3.0-or-later
#include "baker/field/edge_bound.hpp"

#include <Eigen/Core>
#include <algorithm>
#include <cmath>
#include <utility>

#include "common/base/octant.hpp"
#include "common/surface/edge_distance.hpp"

namespace spm::baker {

namespace {

/// Edges sharper than this are not bounded.
constexpr double least_opening = 0.05;
/// Share of a distance that a query's cosine may be wrong by, and what else is rounded.
constexpr double rounding = 1e-6;

constexpr double no_bound = 1e6;  ///< m

}  // namespace

// For distances p = (p1, p2) the field is S(p), the largest of a p1 + b p2 over a, b >= 0 with
// a^2 + b^2 + 2 c a b = 1, for which a n1 + b n2 goes through all directions between both normals.
// So S is convex, above any such a, b, and the sum of two S(p) is above the S of their sum. The
// part of both fields that is linear is farthest above a, b at a corner of the cube.
EdgeBound bound_at_edge(const std::array<FieldBound, 2>& fields, double half, bool larger) {
  const double sign = larger ? 1 : -1;
  const std::array<Quadratic, 2> field{fields[0].near.times(sign), fields[1].near.times(sign)};
  const double cosine = std::clamp(fields[0].normal.dot(fields[1].normal), -1.0, 1.0);
  const double turn = fields[0].turn + fields[1].turn + fields[0].turn * fields[1].turn;
  std::array<double, 2> bent{}, reach{};
  for (std::size_t k = 0; k < 2; ++k) {
    bent[k] = fields[k].bent(half);
    reach[k] = fields[k].reach(half);
  }
  EdgeDistance at = edge_distance(field[0].value, field[1].value, cosine);
  EdgeBound bound;
  bound.value = sign * at.distance;
  const auto may_be_past = [&](std::size_t k) {
    const std::size_t other = 1 - k;
    const double changes = half * (field[k].gradient - cosine * field[other].gradient).lpNorm<1>() +
                           bent[k] + std::abs(cosine) * bent[other] +
                           turn * (std::abs(field[other].value) + reach[other]);
    return field[k].value - cosine * field[other].value + changes > 0;
  };
  bound.edge = std::max(field[0].value + reach[0], field[1].value + reach[1]) > 0 &&
               may_be_past(0) && may_be_past(1);
  const double opening = 1 + cosine - turn;
  if (!bound.edge) return bound;
  if (!(opening > least_opening)) {
    bound.past = bound.below = bound.above = no_bound;
    return bound;
  }
  bound.past = (std::sqrt(2 / opening) - 1 + rounding) *
               std::max(field[0].value + reach[0], field[1].value + reach[1]);
  // Beside the edge itself the direction between both serves best.
  const double longest = std::sqrt(2 / (1 + cosine));
  if (std::abs(at.distance) < half) at.first = at.second = longest / 2;
  bound.near = {field[0].middle, at.first * field[0].value + at.second * field[1].value,
                at.first * field[0].gradient + at.second * field[1].gradient,
                at.first * field[0].bend + at.second * field[1].bend};
  double rises = 0;
  for (std::size_t octant = 0; octant < 8; ++octant) {
    const Vector3 way = half * octant_direction(octant);
    const EdgeDistance there = edge_distance(field[0].value + field[0].gradient.dot(way),
                                             field[1].value + field[1].gradient.dot(way), cosine);
    rises = std::max(rises, there.distance - bound.near.value - bound.near.gradient.dot(way));
  }
  const double bends = at.first * bent[0] + at.second * bent[1];
  // All a, b lie between these three.
  const double outer = 1 / (1 + cosine);
  double curved = 0;
  for (const auto& [a, b] : {std::pair{1.0, 0.0}, {0.0, 1.0}, {outer, outer}}) {
    curved = std::max(curved, std::abs(a - at.first) * bent[0] + std::abs(b - at.second) * bent[1]);
  }
  rises += curved;
  const double off = at.first * fields[0].off + at.second * fields[1].off;
  const double most =
      std::abs(bound.near.value) + half * bound.near.gradient.lpNorm<1>() + bends + rises;
  // Another cosine makes directions longer or shorter.
  const double shrinks = 2 * at.first * at.second * turn;
  bound.below = shrinks <= 0.5 ? off + (shrinks + rounding) * most : no_bound;
  bound.above = off + rises + (turn / (2 * opening) + rounding) * most;
  if (!larger) {
    bound.near = bound.near.times(-1);
    std::swap(bound.below, bound.above);
  }
  return bound;
}

}  // namespace spm::baker
