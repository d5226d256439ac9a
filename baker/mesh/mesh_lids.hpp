// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "baker/mesh/mesh.hpp"

namespace spm::baker {

/// What open surfaces are taken for.
struct Lids {
  std::vector<Hole> holes;  ///< that lids close, largest first
  std::vector<char> sheet;  ///< by triangle, whether it is a sheet's
  /// By triangle the number of the closed patch, or of the open surface with its lids.
  std::vector<std::uint32_t> parts;
  std::uint32_t sheets = 0;  ///< parts that are sheets
  std::size_t added = 0;     ///< triangles of lids
};

/// Closes small holes, as scans have them: an open surface whose lids take no more than 5 % of its
/// area gets them, and bounds a solid with them. Each lid spans its hole by the triangles of the
/// least area. A surface that is more open is a sheet, and so is one that ends in edges where its
/// triangles cannot agree on a side, or a part, open or not, that lies in a plane, within a
/// distance, m. The lids' triangles are added at the end.
[[nodiscard]] Lids add_lids(std::span<const Vector3> points, OpenAs open_as, double flat_within,
                            std::vector<Triangle>& triangles);

}  // namespace spm::baker
