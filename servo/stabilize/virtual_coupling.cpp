// SPDX-License-Identifier: Apache-2.0
#include "servo/stabilize/virtual_coupling.hpp"

namespace spm {

VirtualCoupling::VirtualCoupling(const CouplingSettings& settings, double asked,
                                 double tick) noexcept
    : coupling_(settings.stiffness),
      asked_(asked),
      felt_(felt_stiffness(asked, settings.stiffness)) {
  if (!on()) return;
  inner_ = felt_ / (1 - felt_ / coupling_);
  damper_ = settings.damping / tick;
}

/// Solves the balance K_s (w - e) = K_c e + b (e - e') / T for e, the displacement of the point
/// from the hand. w is the displacement from the hand to what holds the point, and e' is e of the
/// tick before. Without contact K_s is 0.
Vector3 VirtualCoupling::damped(const Vector3& way) noexcept {
  if (!(damper_ > 0)) return Vector3::Zero();
  const Vector3 held = damper_ * stretch_;
  const Vector3 stretch = (inner_ * way + held) / (inner_ + coupling_ + damper_);
  const Vector3 force = inner_ * (way - stretch);
  if (force.dot(way) > 0) {
    stretch_ = stretch;
    return force - felt_ * way;
  }
  stretch_ = held / (coupling_ + damper_);
  return -felt_ * way;
}

}  // namespace spm
