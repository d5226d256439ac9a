// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <cstdint>
#include <vector>

#include "baker/cast/cast.hpp"

namespace spm::baker {

/// The triangles that can hold the closest point of some point of the cube, in
/// ascending order. A triangle is left out only if another one is closer to every part of the cube.
/// Conservative.
[[nodiscard]] std::vector<std::uint32_t> closest_candidates(const Caster& caster,
                                                            const Vector3& middle, double edge,
                                                            double middle_distance);

}  // namespace spm::baker
