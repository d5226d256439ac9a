// SPDX-License-Identifier: Apache-2.0
#include "servo/devices/spacemouse/spacemouse_motion.hpp"

#include <cmath>

namespace spm::servo {

namespace {

Vector3 beyond_dead_zone(const std::array<double, 3>& deflection, double dead_zone) noexcept {
  Vector3 result;
  for (std::size_t i = 0; i < 3; ++i) {
    result[static_cast<int>(i)] = spm::servo::beyond_dead_zone(deflection[i], dead_zone);
  }
  return result;
}

}  // namespace

double beyond_dead_zone(double deflection, double dead_zone) noexcept {
  const double size = std::abs(deflection);
  if (!(size > dead_zone)) return 0;
  return std::copysign((size - dead_zone) / (1 - dead_zone), deflection);
}

void SpaceMouseMotion::step(const SpaceMouseState& mouse, double time) noexcept {
  const double edge = options_.box / 2;
  position_ += beyond_dead_zone(mouse.push, options_.dead_zone) * (options_.speed * time);
  position_ = position_.cwiseMax(-edge).cwiseMin(edge);

  const Vector3 turned = beyond_dead_zone(mouse.twist, options_.dead_zone) * (options_.turn * time);
  const double angle = turned.norm();
  if (!(angle > 0)) return;
  const Eigen::Quaterniond step(Eigen::AngleAxisd(angle, turned / angle));
  orientation_ = (step * orientation_).normalized();
}

}  // namespace spm::servo
