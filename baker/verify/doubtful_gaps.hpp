// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <memory>
#include <vector>

#include "baker/mesh/mesh.hpp"
#include "baker/verify/exact_surface.hpp"
#include "baker/verify/outcome.hpp"
#include "common/query/query.hpp"

namespace spm::baker {

/// Gaps narrower than so many times the width that is closed are closed; wider ones than so many
/// times it are open. Either is right of those between: how wide a gap is at a place, and what is
/// beside its end, is a matter of how its walls were cut.
inline constexpr double surely_closed = 0.5, surely_open = 4;

/// The surfaces of a mesh with its doubtful gaps open and closed. They are made where they are
/// first asked for.
class DoubtfulGaps {
 public:
  /// `tolerance`, m, of what is judged.
  DoubtfulGaps(const Mesh& mesh, const AssetView& view, double tolerance)
      : mesh_(mesh), view_(view), tolerance_(tolerance) {}

  /// Judges once more the places whose answers are off by more than the tolerance, or missing.
  /// Right is what lies between the distances to these surfaces.
  void judge(std::vector<Outcome>& outcomes);

 private:
  const Mesh& mesh_;
  const AssetView& view_;
  double tolerance_;
  std::vector<std::unique_ptr<const ExactSurface>> surfaces_;
};

}  // namespace spm::baker
