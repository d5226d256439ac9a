// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <array>
#include <cstdint>
#include <functional>
#include <map>
#include <vector>

#include "baker/mesh/mesh.hpp"
#include "baker/mesh/sliver_removal.hpp"

namespace spm::baker {

/// Of the pieces that a triangle of a sheet was cut into, those that are felt.
struct PiecesOfSheet {
  std::vector<Triangle> felt;
  bool any_hidden = false;  ///< there are others
};

/// Whether a piece of a triangle of the mesh is felt, by its corners.
using IsFelt = std::function<bool(const std::array<Vector3, 3>&, const LooseTriangle&)>;

/// What is felt of sheets, by triangle of the mesh, whose vertices are the first of `points`: each
/// triangle is cut anew, along the outline of its felt pieces alone, since nothing has to meet the
/// cuts of a sheet. Cuts add points.
[[nodiscard]] std::vector<LooseTriangle> felt_of_sheets(
    const Mesh& mesh, const std::map<std::uint32_t, PiecesOfSheet>& sheets,
    std::vector<Vector3>& points, const IsFelt& is_felt);

}  // namespace spm::baker
