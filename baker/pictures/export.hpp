// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <string>

#include "common/contour/contour_mesh.hpp"

namespace spm::baker {

/// A surface as a PLY file's bytes: binary little endian, or text.
[[nodiscard]] std::string to_ply(const ContourMesh& surface, bool text);

}  // namespace spm::baker
