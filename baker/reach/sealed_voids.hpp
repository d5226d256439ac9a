// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <optional>

#include "baker/cast/cast.hpp"
#include "baker/surface/outer_surface.hpp"

namespace spm::baker {

/// The caster's surface with its sealed voids filled: the walls of hollows that not even a point
/// comes into from outside are left out, and so is what lies in such hollows. Nothing where there
/// are none. A part of the surface whose edges do not all pair up is taken for reachable.
[[nodiscard]] std::optional<OuterSurface> without_sealed_voids(const Caster& caster);

}  // namespace spm::baker
