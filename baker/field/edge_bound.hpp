// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <array>

#include "baker/charts/bounded_field.hpp"

namespace spm::baker {

/// What two fields and the edge between them tell (edge_distance), over a cube.
struct EdgeBound {
  double value = 0;   ///< m, in the middle, exact but for rounding
  bool edge = false;  ///< whether the edge may be what is nearest to a place; else no more is known
  double past = 0;  ///< m: it is no farther than the larger, or smaller, of both by more than this
  Quadratic near;
  double below = 0, above = 0;  ///< m: the field is no farther from `near`
};

/// The larger of two fields in front of a convex edge, or the smaller one behind a concave edge,
/// over a cube with edges of twice `half`, m.
[[nodiscard]] EdgeBound bound_at_edge(const std::array<FieldBound, 2>& fields, double half,
                                      bool larger);

}  // namespace spm::baker
