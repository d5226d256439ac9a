// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <vector>

#include "baker/mesh/mesh.hpp"
#include "baker/mesh/mesh_reader.hpp"

namespace spm::baker {

/// Merges equal points, drops zero-area and duplicated triangles and unreferenced points, orients,
/// turns what is inside out, and tells solids from sheets, by the rules of SOLID.md. Fills
/// everything of the mesh but path, hash, unit, scale, box and what its open surfaces are to be
/// taken for. The mesh has no triangle where no triangle of the soup has an area.
void repair(PolygonSoup soup, Mesh& mesh);

/// Keeps the vertices that triangles refer to, in their order, and renumbers the triangles.
void compact(std::vector<Vector3>& vertices, std::vector<Triangle>& triangles);

/// True where three points lie on a line or coincide, by exact arithmetic.
[[nodiscard]] bool collinear(const Vector3& a, const Vector3& b, const Vector3& c);

}  // namespace spm::baker
