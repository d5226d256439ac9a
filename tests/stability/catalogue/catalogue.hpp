// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <string>
#include <vector>

#include "tests/stability/objects/stability_case.hpp"

namespace spm::stability {

/// All cases of a hand with three degrees of freedom, theme by theme. A case whose mesh is not on
/// this machine is among them: see why_unprepared.
[[nodiscard]] std::vector<StabilityCase> whole_catalogue();

/// The cases that can be run on this machine.
[[nodiscard]] std::vector<StabilityCase> catalogue();

/// A sentence for each case that cannot be run on this machine: its name, and why not.
[[nodiscard]] std::vector<std::string> left_out_cases();

// One function per theme.

/// A flat wall: its border, delays, a coarse encoder, taps, noise, and tiles that switch.
[[nodiscard]] std::vector<StabilityCase> wall_cases();
/// Plates, a bar and a taper: objects so thin that a depth does not tell which side is meant.
[[nodiscard]] std::vector<StabilityCase> thin_cases();
/// Grooves, a slot, a corner and a pit: a ball that touches several walls at once.
[[nodiscard]] std::vector<StabilityCase> groove_cases();
/// Friction and texture where they ought to be quiet.
[[nodiscard]] std::vector<StabilityCase> effect_cases();
/// Objects that move, are exchanged, or are resolved now finer, now coarser.
[[nodiscard]] std::vector<StabilityCase> moving_cases();
/// Closed paths without dynamics: what a force that comes from no potential energy gains on them.
[[nodiscard]] std::vector<StabilityCase> loop_cases();
/// Real objects, from the shared meshes.
[[nodiscard]] std::vector<StabilityCase> mesh_cases();

}  // namespace spm::stability
