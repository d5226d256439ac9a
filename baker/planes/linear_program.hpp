// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <cstdint>
#include <optional>
#include <vector>

#include "common/base/vector.hpp"

namespace spm::baker {

/// The half-space normal . x <= offset; the normal is of unit length.
struct HalfSpace {
  Vector3 normal = Vector3::UnitZ();
  double offset = 0;
};

/// Shuffles half-spaces in place, in an order that the seed fixes. The expected linear time of
/// `maximise` needs shuffled constraints.
void shuffle(std::vector<HalfSpace>& constraints, std::uint64_t seed);

/// The point that lies farthest along `objective` within all half-spaces and the cube |x_k| <=
/// bound. Seidel's algorithm: the expected time is linear in the number of constraints, if they are
/// shuffled. The point may lie outside a constraint by about 1e-13 of the coordinates; a constraint
/// is never made tighter than it is. Empty where the half-spaces have no point in common within
/// that.
[[nodiscard]] std::optional<Vector3> maximise(const std::vector<HalfSpace>& constraints,
                                              const Vector3& objective, double bound);

}  // namespace spm::baker
