// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <vector>

#include "baker/mesh/mesh.hpp"
#include "baker/verify/outcome.hpp"
#include "common/query/query.hpp"

namespace spm::baker {

/// Gaps narrower than so many times the width that is closed are closed; wider ones than so many
/// times it are open. Either is right of those between: how wide a gap is at a place, and what is
/// beside its end, is a matter of how its walls were cut.
inline constexpr double surely_closed = 0.5, surely_open = 4;

/// Judges once more the places whose answers are off by more than the tolerance, or missing. Right
/// is what lies between the distances with the doubtful gaps open and closed. Nothing changes where
/// the mesh has no such gap.
void judge_doubtful_gaps(const Mesh& mesh, const AssetView& view, double tolerance,
                         std::vector<Outcome>& outcomes);

}  // namespace spm::baker
