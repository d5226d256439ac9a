// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <functional>
#include <optional>

#include "common/surface/tile.hpp"

namespace spm::baker {

/// The line that keeps most of a cell's sheet and nothing beyond it: the cell of side 1 around
/// (x, y); `on_sheet` tells of a place. Nothing where no line keeps a worthwhile part.
[[nodiscard]] std::optional<Clip> fit_clip(double x, double y,
                                           const std::function<bool(double, double)>& on_sheet);

}  // namespace spm::baker
