// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <optional>
#include <string>

#include "baker/mesh/mesh.hpp"

namespace spm::baker {

struct LoadOptions {
  std::optional<double> unit = {};          ///< metres; else as the file says, or 1
  std::optional<double> fit_diagonal = {};  ///< m
  std::optional<double> scale = {};         ///< in place of it: the factor about the origin
  bool outside_buffers = false;             ///< a glTF may name buffers outside its own folder
  OpenAs open_as = OpenAs::automatic;       ///< what open surfaces are taken for
};

/// Reads glTF (`.gltf`, `.glb`), 3MF, OBJ, PLY, STL or OFF, also compressed by gzip. Fans polygons
/// from their first vertex, or spans them by the least area where fans fold, merges equal points,
/// drops zero-area and duplicated triangles, orients, stitches and turns inverted components, then
/// scales. Throws BakeError: file_or_device, or invalid_input, which names file, place, cause and
/// what to do.
[[nodiscard]] Mesh load_mesh(const std::string& path, const LoadOptions& options);

}  // namespace spm::baker
