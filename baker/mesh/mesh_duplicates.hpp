// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <cstddef>
#include <vector>

#include "baker/mesh/mesh.hpp"

namespace spm::baker {

/// Drops triangles that lie on another with the same corners and returns how many. Those that face
/// each other are a wall between two parts and both go, except where most of the mesh is drawn from
/// both sides: then one of each pair stays. Those that face the same way go but for one, except
/// where two parts share a face and dropping it would open one of them.
std::size_t drop_duplicates(std::vector<Triangle>& triangles);

}  // namespace spm::baker
