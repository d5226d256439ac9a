// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <array>
#include <cstdint>
#include <string>
#include <vector>

#include "common/base/vector.hpp"

namespace spm::baker {

using Triangle = std::array<std::uint32_t, 3>;

/// A mesh after loading, repair, unit and scale: in metres, in the asset's frame. Triangles are
/// oriented so that their normals point out of the solid, as far as that is defined.
struct Mesh {
  std::vector<Vector3> vertices;    ///< all are referenced
  std::vector<Triangle> triangles;  ///< no index out of range, no zero area
  std::string path;
  std::string sha256;  ///< of the file's bytes; see mesh_sha256
  double unit = 1;     ///< metres per unit of the file
  double scale = 1;    ///< of --fit-diagonal
  Vector3 box_min = Vector3::Zero();
  Vector3 box_max = Vector3::Zero();
  double diagonal = 0;
  std::uint64_t file_triangles = 0;  ///< after fanning polygons, before repair
  std::uint64_t file_vertices = 0;
  std::uint32_t components = 0;
  std::uint64_t border_edges = 0;
  std::vector<std::array<std::uint32_t, 2>> border;  ///< the border edges, indices of vertices
  std::uint32_t inverted_components = 0;             ///< components that were inside out
  std::uint64_t dropped_triangles = 0;               ///< zero area or duplicated
  std::vector<std::string> notes;  ///< findings and assumptions, a sentence each, for the user
  [[nodiscard]] bool closed() const noexcept { return border_edges == 0; }
};

}  // namespace spm::baker
