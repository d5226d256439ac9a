// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <functional>
#include <optional>

#include "common/surface/tile.hpp"

namespace spm::baker {

/// The line that keeps most of a cell's surface and nothing beyond it. The cell has side 1 and lies
/// around (x, y). `on_layer` says whether a place is on the surface. Empty where no line keeps a
/// worthwhile part.
[[nodiscard]] std::optional<Clip> fit_clip(double x, double y,
                                           const std::function<bool(double, double)>& on_layer);

}  // namespace spm::baker
