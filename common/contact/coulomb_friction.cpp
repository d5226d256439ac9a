// SPDX-License-Identifier: Apache-2.0
#include "common/contact/coulomb_friction.hpp"

#include <algorithm>
#include <cmath>

namespace spm {

Vector3 coulomb_friction(const FrictionSettings& settings, const Vector3& point,
                         const Vector3& normal, double pressing, FrictionState& state) noexcept {
  const bool usable = pressing > 0 && std::isfinite(pressing) && settings.stiffness > 0 &&
                      point.allFinite() && normal.allFinite();
  if (!usable) {
    state = {};
    return Vector3::Zero();
  }
  if (!state.held) {
    state = {true, false, point};
    return Vector3::Zero();
  }
  Vector3 pull = state.anchor - point;
  pull -= pull.dot(normal) * normal;
  const double stretch = pull.norm();
  const double force = settings.stiffness * stretch;
  const double slide = settings.slide * pressing;
  const double most = std::max(settings.stick, settings.slide) * pressing;
  state.sliding = force > (state.sliding ? slide : most);
  const double kept = state.sliding ? slide / settings.stiffness : stretch;
  if (stretch > 0) pull *= kept / stretch;
  state.anchor = point + pull;
  return settings.stiffness * pull;
}

}  // namespace spm
