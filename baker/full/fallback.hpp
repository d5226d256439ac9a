// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <cstdint>
#include <vector>

#include "baker/cast/cast.hpp"

namespace spm::baker {

/// Triangles, caps included, that can hold the closest point of some point of the cube: all that
/// are not farther than another one from every part of it. Ascending. Conservative.
[[nodiscard]] std::vector<std::uint32_t> closest_candidates(const Caster& caster,
                                                            const Vector3& middle, double edge,
                                                            double middle_distance);

}  // namespace spm::baker
