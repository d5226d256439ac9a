// SPDX-License-Identifier: Apache-2.0
#include "common/matched_damping.hpp"

#include <algorithm>
#include <cmath>

namespace spm {

Vector3 within_reaction(const Vector3& braking, double reaction) noexcept {
  const double size = braking.norm();
  const double share = std::min(1.0, reaction / whole_braking_from);
  // Written so that what is no number brakes nothing.
  if (!(size * share > 0) || !std::isfinite(size)) return Vector3::Zero();
  return std::min(share, reaction / size) * braking;
}

}  // namespace spm
