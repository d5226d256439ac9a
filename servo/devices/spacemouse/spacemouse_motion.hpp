// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "servo/devices/base/device.hpp"
#include "servo/devices/spacemouse/spacemouse_options.hpp"
#include "servo/devices/spacemouse/spacemouse_reports.hpp"

namespace spm::servo {

/// A tool that a SpaceMouse moves. The deflection is a velocity, so that the tool can go anywhere
/// in the box about the origin, and stays where it is when the mouse is released.
class SpaceMouseMotion {
 public:
  explicit SpaceMouseMotion(const SpaceMouseOptions& options) noexcept : options_(options) {}

  /// Moves the tool for a time, s, 0 or more; world frame.
  void step(const SpaceMouseState& mouse, double time) noexcept;

  [[nodiscard]] const Vector3& position() const noexcept { return position_; }
  [[nodiscard]] const Eigen::Quaterniond& orientation() const noexcept { return orientation_; }

 private:
  SpaceMouseOptions options_;
  Vector3 position_ = Vector3::Zero();
  Eigen::Quaterniond orientation_ = Eigen::Quaterniond::Identity();
};

/// The deflection of one axis, -1 to 1, without its dead zone: 0 within the zone, and from there
/// linear to full deflection, without a step.
[[nodiscard]] double beyond_dead_zone(double deflection, double dead_zone) noexcept;

}  // namespace spm::servo
