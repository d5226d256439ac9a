// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <string>
#include <vector>

#include "baker/verify/verify.hpp"

namespace spm::baker {

/// Writes the results of a verification as pictures into a folder, and returns their paths.
/// `surface.png`: the mesh, and beside it the surface as the asset holds it. `error.png`: the mesh
/// coloured by the error. `error-worst.png`: the same, close to the worst place.
/// `error-section.png`: a cut through the band there. All are seen from the side where the worst
/// place lies; see error_on_surface for the colours. Throws BakeError as verify_asset does, and
/// where the folder cannot be written.
std::vector<std::string> write_error_pictures(const AssetView& view, const AssetMetadata& metadata,
                                              const std::string& mesh_path,
                                              const VerifyReport& report,
                                              const std::string& folder);

}  // namespace spm::baker
