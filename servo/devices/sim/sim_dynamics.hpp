// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "common/vector.hpp"
#include "servo/devices/sim/sim_profile.hpp"

namespace spm::servo {

/// Where the hand wants the tool to be.
struct HandTarget {
  Vector3 position = Vector3::Zero();  ///< m
  Vector3 velocity = Vector3::Zero();  ///< m/s
};

/// The moving mass of a simulated device in a hand's grip. Semi-implicit Euler with at least 20
/// substeps a tick, which Coulomb friction and the actuator's lag need.
class SimDynamics {
 public:
  /// `period` in seconds.
  SimDynamics(const SimProfile& profile, double period) noexcept;

  /// Puts the tool at rest at a place.
  void place(const Vector3& position) noexcept;

  /// Goes on by one tick under a commanded force (N, held over the tick, saturated at the
  /// actuator's cap) and the grip, whose target moves on evenly over the tick.
  void step(const Vector3& commanded, const HandTarget& target, double stiffness = grip_stiffness,
            double damping = grip_damping) noexcept;

  [[nodiscard]] const Vector3& position() const noexcept { return position_; }
  [[nodiscard]] const Vector3& velocity() const noexcept { return velocity_; }

  /// The position as the encoders tell it: rounded to their step on each axis.
  [[nodiscard]] Vector3 measured_position() const noexcept;

 private:
  SimProfile profile_;
  int substeps_;
  double step_;      ///< s, of a substep
  double lag_gain_;  ///< share of the way to the command that the actuator goes in a substep
  Vector3 position_ = Vector3::Zero();
  Vector3 velocity_ = Vector3::Zero();
  Vector3 actuator_ = Vector3::Zero();  ///< N
};

}  // namespace spm::servo
