// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "servo/force/placed_contact.hpp"

namespace spm {

/// Whether two settings of an object differ in numbers that can go over into each other: stiffness,
/// friction, damping and texture. Others make the object another one.
[[nodiscard]] bool feels_alike(const PlacedObject& one, const PlacedObject& other) noexcept;

/// Whether these numbers, and the rest but for the place, are the same.
[[nodiscard]] bool feels_the_same(const PlacedObject& one, const PlacedObject& other) noexcept;

/// Takes what is felt of an object a step nearer to what is wanted of it, in `seconds`, where the
/// way there began at `from`. Each number takes change_seconds; the stiffness takes longer where a
/// hand that presses with `pressing` N would feel more than change_rate. At each moment what is
/// felt is an object of one stiffness, so that its force is the gradient of a potential.
void step_towards(PlacedObject& felt, const PlacedObject& from, const PlacedObject& wanted,
                  double seconds, double pressing) noexcept;

}  // namespace spm
