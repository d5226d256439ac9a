// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <span>

#include "baker/charts/bounded_field.hpp"
#include "baker/field/cube_candidates.hpp"
#include "common/asset/asset_view.hpp"

namespace spm::baker {

/// Of what maps tell beyond the margin, the part that is proven (DistanceOctree::beyond_share).
/// With nine tenths more maps would be rejected, and a file be 4 % longer; with this, 0.2 %.
inline constexpr double beyond_share = 0.75;

/// Proves that a field, or two of them, is off by at most
/// `tolerance` (m) at every place of a cube that is in the band, and that beyond the band they tell
/// so, within the tolerance; and that the surface is as far beyond the margin as beyond_share
/// promises, within the tolerance. By bounds over cubes that are divided further and further; by no
/// sample. Adds to the tree. False where it is not so, or where so many cubes do not suffice.
[[nodiscard]] bool prove_fields(const LatticeSurface& surface, CandidateTree& tree, MapPair pair,
                                std::span<const BoundedField* const> fields, const Band& band,
                                double tolerance);

}  // namespace spm::baker
