// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <array>
#include <cstdint>
#include <functional>
#include <vector>

#include "tests/support/shapes.hpp"

namespace spm::stability {

// Closed shapes, in metres; triangles are anticlockwise seen from outside. Where an object has an
// upper side, it is at z = 0.

/// A profile in x and z, anticlockwise seen against y, extruded along y by `length`, half each way.
/// The whole profile must be visible from its first point.
[[nodiscard]] test::Shape prism(const std::vector<std::array<double, 2>>& profile, double length);

/// The filled ones of the cells between the planes at `xs`, `ys` and `zs` (each rising). Filled
/// cells may touch each other only by faces.
[[nodiscard]] test::Shape cells(const std::vector<double>& xs, const std::vector<double>& ys,
                                const std::vector<double>& zs,
                                const std::function<bool(int, int, int)>& filled);

/// 60 x 60 x 40 mm.
[[nodiscard]] test::Shape flat_block();

/// 30 x 30 mm.
[[nodiscard]] test::Shape flat_plate(double thickness);

/// The same plate twice, the second below the first with a gap between them.
[[nodiscard]] test::Shape two_plates(double thickness, double gap);

/// A square bar along y, 40 mm long.
[[nodiscard]] test::Shape square_bar(double side);

/// A plate whose upper side is flat; x from -15 to 15 mm, 30 mm along y. Its thickness goes evenly
/// from `thick` on the left to `thin` on the right.
[[nodiscard]] test::Shape taper(double thick, double thin);

/// A block with a V along y, `depth` deep at x = 0, that opens by `angle` (rad); 15 mm long, 4 mm
/// wider than the V on each side, and twice as high.
[[nodiscard]] test::Shape groove(double angle, double depth);

/// A block with a slot along y, about x = 0, with upright walls; 20 x 15 mm, 5 mm below the slot.
[[nodiscard]] test::Shape slot(double width, double depth);

/// Three walls that meet at the origin; the free space is where x, y and z are above 0, up to 8 mm.
[[nodiscard]] test::Shape inner_corner();

/// A round block with a cone about z, whose sides are at 90 degrees to each other, `depth` deep.
[[nodiscard]] test::Shape cone_pit(double depth);

/// A plate of 12 x 12 x 6 mm whose upper side has squares of 1 mm, two triangles each, with
/// corners raised or lowered at random by up to `height`: tilted by up to about 2.8 height / 1 mm.
[[nodiscard]] test::Shape faceted_wall(double height, std::uint64_t seed);

}  // namespace spm::stability
