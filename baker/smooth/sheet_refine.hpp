// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <cstddef>
#include <functional>

#include "baker/smooth/sheet.hpp"

namespace spm::baker {

/// Says whether the surroundings of an edge must be refined.
using EdgeChoice = std::function<bool(const SheetEdge&)>;

/// Halves the edges longer than `longest` metres that are within `reach` metres of a chosen edge,
/// until there are none. Vertices keep their places and indices. Where the surface is flat, edges
/// may be laid anew. Throws BakeError usage where that takes more than `most` triangles.
[[nodiscard]] Sheet refined(Sheet sheet, const EdgeChoice& choice, double longest, double reach,
                            std::size_t most);

}  // namespace spm::baker
