// SPDX-License-Identifier: Apache-2.0
#include "servo/force/force_blend.hpp"

#include <algorithm>

#include "common/base/smooth_change.hpp"
#include "common/base/turn_between.hpp"

namespace spm {

namespace {

/// A vector of that length and direction, longer by what was moved against it.
Vector3 pressed(const Vector3& vector, double stiffness, const Vector3& moved) noexcept {
  const double size = vector.norm();
  if (!(size > 0)) return Vector3::Zero();
  const Vector3 along = vector / size;
  return std::max(0.0, size - stiffness * along.dot(moved)) * along;
}

/// N: how far apart two wrenches are felt.
double apart(const Wrench& one, const Wrench& other) noexcept {
  return std::max((one.force - other.force).norm(),
                  (one.torque - other.torque).norm() / finger_arm);
}

}  // namespace

Wrench WrenchSpring::wrench_at(const HandPose& hand) const noexcept {
  return {pressed(wrench.force, stiffness, hand.position - at.position),
          pressed(wrench.torque, turning, turn_between(at.orientation, hand.orientation))};
}

double WrenchSpring::energy_at(const HandPose& hand) const noexcept {
  return stiffness > 0 ? 0.5 * wrench_at(hand).force.squaredNorm() / stiffness : 0;
}

void ForceBlend::begin(const WrenchSpring& before) noexcept {
  before_ = before;
  left_ = 1;
}

Wrench ForceBlend::next(const Wrench& law, const HandPose& hand, std::uint64_t ticks) noexcept {
  if (!running()) return law;
  const Wrench before = before_.wrench_at(hand);
  left_ =
      std::max(0.0, left_ - change_share(static_cast<double>(ticks) * tick_, apart(before, law)));
  return {left_ * before.force + (1 - left_) * law.force,
          left_ * before.torque + (1 - left_) * law.torque};
}

bool differ_by_a_step(const Wrench& one, const Wrench& other, double seconds) noexcept {
  return apart(one, other) > change_rate * seconds;
}

}  // namespace spm
