// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <nlohmann/json_fwd.hpp>

#include "common/oriented_box.hpp"

namespace spm::baker {

/// Whether an axis-aligned cube (middle and edge, m) may touch the box: never wrong where it does,
/// and where it says so they are less than the cube's diagonal apart. Edge 0 asks for a point.
[[nodiscard]] bool may_touch(const OrientedBox& box, const Vector3& middle, double edge) noexcept;

/// Whether a point of a triangle lies in the box.
[[nodiscard]] bool touches_triangle(const OrientedBox& box, const Vector3& a, const Vector3& b,
                                    const Vector3& c);

/// The box with each face moved outwards by `distance`, metres.
[[nodiscard]] OrientedBox grown(OrientedBox box, double distance) noexcept;

/// `{middle, axes, half}`, as an asset's options record it.
[[nodiscard]] nlohmann::ordered_json to_json(const OrientedBox& box);

}  // namespace spm::baker
