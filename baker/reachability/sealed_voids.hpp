// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <optional>

#include "baker/cast/cast.hpp"
#include "baker/surface/outer_surface.hpp"

namespace spm::baker {

/// The caster's surface with its sealed voids filled. It leaves out the walls of hollows that not
/// even a point can enter from outside, and everything in such hollows. Empty where there are no
/// such hollows. A part of the surface whose edges do not all pair up counts as reachable.
[[nodiscard]] std::optional<OuterSurface> without_sealed_voids(const Caster& caster);

}  // namespace spm::baker
