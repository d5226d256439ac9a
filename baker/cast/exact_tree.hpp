// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <cstdint>

#include "baker/mesh/mesh.hpp"

namespace spm::baker {

/// What Embree's compact tree of a mesh's exact triangles takes in memory, with their corners in
/// floats, bytes: the same on every run. A lower bound where that alone is `enough` or more, since
/// a large tree takes long. Throws BakeError where Embree cannot be started.
[[nodiscard]] std::uint64_t exact_tree_bytes(const Mesh& mesh, std::uint64_t enough);

}  // namespace spm::baker
