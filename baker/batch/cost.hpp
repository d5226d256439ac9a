// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include "baker/build/build_request.hpp"

namespace spm::baker {

/// About how long a bake takes on one core, s: from the size of the mesh's file, its kind and the
/// tolerance, without reading the mesh. Good enough to share work out, and the same on every
/// machine that sees the same files. A missing mesh costs next to nothing.
[[nodiscard]] double estimated_cost(const BuildRequest& request);

/// About how much memory a bake takes at most, bytes; rather more than less.
[[nodiscard]] double estimated_memory(const BuildRequest& request);

/// About how many triangles a mesh file of a size holds, by its extension.
[[nodiscard]] double estimated_triangles(const std::string& path);

}  // namespace spm::baker
