// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <string>
#include <vector>

#include "baker/pictures/picture.hpp"
#include "baker/verify/verify.hpp"

namespace spm::baker {

/// Cells along the longest edge, of the grid of the surface that pictures show.
inline constexpr int picture_cells = 160;

/// A picture and the name of its file.
struct NamedPicture {
  const char* name = "";
  Picture picture;
};

/// The results of a verification as pictures. "Close" means about the worst place; all are seen
/// from the side where that lies.
/// - `surface.png`: the mesh, and beside it the surface as the asset holds it
/// - `structure.png`: the mesh coloured by what answers there, and beside it a cut through the band
///   close by, see structure_colours
/// - `direction.png`: the mesh coloured by how far directions are off at an eighth of the band's
///   depth inside, 15 degrees at the end of the colours, and beside it the same close by; grey
///   where nothing is judged, see not_judged
/// - `error.png`: the mesh coloured by the error; `error-worst.png`: the same close by, see
///   error_on_surface
/// - `error-section.png`: a cut through the band there
/// Throws BakeError as verify_asset does.
[[nodiscard]] std::vector<NamedPicture> error_pictures(const AssetView& view,
                                                       const AssetMetadata& metadata,
                                                       const std::string& mesh_path,
                                                       const VerifyReport& report);

/// Writes them into a folder, and returns their paths. Throws BakeError, also where the folder
/// cannot be written.
std::vector<std::string> write_error_pictures(const AssetView& view, const AssetMetadata& metadata,
                                              const std::string& mesh_path,
                                              const VerifyReport& report,
                                              const std::string& folder);

}  // namespace spm::baker
