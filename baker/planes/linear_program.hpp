// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <cstdint>
#include <optional>
#include <vector>

#include "common/base/half_space.hpp"

namespace spm::baker {

/// Shuffles half-spaces in place by a fixed sequence of the seed: what the expected linear time of
/// `maximise` rests on.
void shuffle(std::vector<HalfSpace>& constraints, std::uint64_t seed);

/// The point that lies farthest along `objective` within all half-spaces and the cube |x_k| <=
/// bound. Seidel's algorithm: expected time linear in the number of constraints, if they are
/// shuffled. A constraint may be overstepped by about 1e-13 of the coordinates, never
/// overtightened; empty where the half-spaces have no point in common within that.
[[nodiscard]] std::optional<Vector3> maximise(const std::vector<HalfSpace>& constraints,
                                              const Vector3& objective, double bound);

}  // namespace spm::baker
