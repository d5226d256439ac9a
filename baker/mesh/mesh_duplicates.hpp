// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <cstddef>
#include <vector>

#include "baker/mesh/mesh.hpp"

namespace spm::baker {

/// Drops triangles that have the same corners as another one, and returns how many, with a corner
/// of one. Two triangles that face each other are a wall between two parts, and both go. One of
/// them stays where the surface would be open without it, where they end freely, as a leaf that is
/// drawn from both sides does, and where most of the mesh is drawn so. Of triangles that face the
/// same way one stays, except where two parts share a face and dropping it would open one of them.
Counted drop_duplicates(std::vector<Triangle>& triangles);

}  // namespace spm::baker
