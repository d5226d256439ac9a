// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <Eigen/Geometry>
#include <cstdint>

#include "common/base/random.hpp"
#include "common/base/turn_between.hpp"
#include "common/base/wrench.hpp"
#include "servo/devices/sim/actuator_line.hpp"
#include "servo/devices/sim/hand_model.hpp"
#include "servo/devices/sim/sim_profile.hpp"

namespace spm::servo {

/// A device and hand in six degrees of freedom. No data sheet gives the rotational values, so all
/// of them are assumed. The handle's mass, damping and friction sit `gyration` from its middle. Its
/// angles are read by encoders with the profile's step, `encoder_lever` away. Its motors turn it
/// with at most the force cap times `torque_lever`.
struct SixdofSettings {
  SimProfile profile = sim_profiles[0];
  double period = 1e-3;   ///< s, of a tick
  int substeps = 20;      ///< per tick, 1 or more
  double mass_scale = 1;  ///< above 0; factor on the profile's mass and inertia
  /// m, radii about the handle's own axes
  Vector3 gyration = Vector3::Constant(assumed_gyration);
  double encoder_lever = assumed_encoder_lever;  ///< m
  double torque_lever = assumed_torque_lever;    ///< m; 0: no torque acts
  double friction_scale = 1;                     ///< of the profile's Coulomb friction; 0: none
  double encoder_step = -1;                      ///< m; below 0: the profile's; 0: none
  double delay_ticks = 1;              ///< 0 to longest_delay; a fraction acts within a tick
  HandModel hand = HandModel::arm;     ///< with `none`, no hand turns it either
  double grip_share = 1;               ///< of the grip's springs and dampers, 0 or more
  double grip_turning = 2;             ///< N m/rad; assumed
  double grip_turning_damping = 0.01;  ///< N m s/rad; assumed
  Vector3 weight = Vector3::Zero();    ///< N, on the handle's middle, world frame
  double jitter = 0;      ///< s, standard deviation of a wrench's arrival; never early, in order
  double lost_share = 0;  ///< 0 to 1, of the ticks whose wrench never arrives
  double noise = 0;       ///< m, standard deviation for each tick and axis; of turns over the lever
  std::uint64_t seed = 1;
};

/// The pose that the hand wants the tool to have at a tick's end, and its motion there.
struct SixdofTarget {
  Vector3 position = Vector3::Zero();  ///< m
  Eigen::Quaterniond orientation = Eigen::Quaterniond::Identity();
  Vector3 velocity = Vector3::Zero();          ///< m/s
  Vector3 angular_velocity = Vector3::Zero();  ///< rad/s, world frame
};

/// One tick of the plant. Wrenches are means over the tick, about the handle's middle, world frame.
/// Works are taken over the true motion, J. The change of the handle's kinetic energy is `work +
/// hand_work + weight_work - dissipated`.
struct SixdofTick {
  Wrench hand;
  Wrench actuator;
  double work = 0;         ///< of the actuators
  double hand_work = 0;    ///< of the grip
  double weight_work = 0;  ///< of gravity
  double dissipated = 0;   ///< by the device's own damping and friction
};

/// A rigid handle in a hand's grip, under a wrench that is held constant over each tick. Integrated
/// by Strang splitting: half a drift, a kick with implicit dampers, half a drift. This is second
/// order, and without torque the momentum is kept to rounding.
class SixdofPlant {
 public:
  explicit SixdofPlant(const SixdofSettings& settings) noexcept;

  /// Places the tool at rest, and the arm too where there is one; forgets earlier commands.
  void place(const Eigen::Isometry3d& pose) noexcept;

  /// Sets the handle's motion: m/s and rad/s, world frame.
  void set_motion(const Vector3& velocity, const Vector3& angular_velocity) noexcept;

  /// Advances by one tick. `commanded` is the answer to the reading before this tick and acts
  /// `delay_ticks` later.
  SixdofTick step(const Wrench& commanded, const SixdofTarget& target) noexcept;

  [[nodiscard]] const Eigen::Isometry3d& pose() const noexcept { return pose_; }
  /// The pose as the encoders read it, with the tick's noise: each coordinate of the position, and
  /// the turn since `place` as axis times angle, each rounded to its step. The turn must be below
  /// half a turn.
  [[nodiscard]] Eigen::Isometry3d measured_pose() const noexcept;
  [[nodiscard]] const Vector3& velocity() const noexcept { return velocity_; }
  [[nodiscard]] Vector3 angular_velocity() const noexcept;  ///< rad/s, world frame
  [[nodiscard]] const Vector3& angular_momentum() const noexcept { return momentum_; }
  [[nodiscard]] double kinetic_energy() const noexcept;  ///< J, of the handle

  [[nodiscard]] double mass() const noexcept { return mass_; }
  [[nodiscard]] const Vector3& inertia() const noexcept { return inertia_; }  ///< kg m2
  [[nodiscard]] double turn_step() const noexcept;                            ///< rad
  [[nodiscard]] double torque_cap() const noexcept;                           ///< N m
  /// A wrench within the actuators' caps.
  [[nodiscard]] Wrench reachable(const Wrench& commanded) const noexcept;

 private:
  SixdofSettings settings_;
  double step_;  ///< s, of a substep
  double mass_;
  Vector3 inertia_;
  double grip_;  ///< share of the grip
  double encoder_step_;

  Random noise_source_;
  Vector3 noise_ = Vector3::Zero();       ///< m, of the present reading
  Vector3 turn_noise_ = Vector3::Zero();  ///< rad
  Eigen::Isometry3d pose_ = Eigen::Isometry3d::Identity();
  Eigen::Quaterniond orientation_ = Eigen::Quaterniond::Identity();
  Eigen::Quaterniond start_ = Eigen::Quaterniond::Identity();
  Vector3 velocity_ = Vector3::Zero();
  Vector3 momentum_ = Vector3::Zero();  ///< angular, world frame
  Vector3 arm_ = Vector3::Zero();       ///< m
  Vector3 arm_velocity_ = Vector3::Zero();
  ActuatorLine forces_, torques_;
  Wrench actuator_;  ///< the wrench that acts in the current substep

  [[nodiscard]] Vector3 body_rates() const noexcept;
  void draw_noise() noexcept;
  void drift(double seconds) noexcept;
  void kick(const SixdofTarget& target, double before_end, SixdofTick& tick) noexcept;
  void kick_place(const Vector3& wanted, const Vector3& speed, SixdofTick& tick) noexcept;
  void kick_turn(const Eigen::Quaterniond& wanted, const Vector3& rate, SixdofTick& tick) noexcept;
};

/// The orientation after a turn, axis times angle (rad).
[[nodiscard]] Eigen::Quaterniond orientation_of(const Vector3& turn) noexcept;

}  // namespace spm::servo
