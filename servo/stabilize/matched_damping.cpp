// SPDX-License-Identifier: Apache-2.0
#include "servo/stabilize/matched_damping.hpp"

#include <algorithm>
#include <cmath>

namespace spm {

double braking_share(double braking, double reaction, double full_from) noexcept {
  const double share = std::min(1.0, reaction / full_from);
  // Written so that NaN gives no damping.
  if (!(braking * share > 0) || !std::isfinite(braking)) return 0;
  return std::min(share, reaction / braking);
}

Vector3 within_reaction(const Vector3& braking, double reaction, double full_from) noexcept {
  const double share = braking_share(braking.norm(), reaction, full_from);
  if (!(share > 0)) return Vector3::Zero();
  return share * braking;
}

Vector3 along_reaction(const Vector3& braking, const Vector3& reaction, double full_from) noexcept {
  const double size = reaction.norm();
  if (!(size > 0)) return Vector3::Zero();
  const Vector3 direction = reaction / size;
  return within_reaction(braking.dot(direction) * direction, size, full_from);
}

}  // namespace spm
