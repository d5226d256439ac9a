// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <Eigen/Core>
#include <cstdint>

#include "common/base/random.hpp"
#include "common/base/vector.hpp"
#include "servo/devices/sim/actuator_line.hpp"
#include "servo/devices/sim/hand_model.hpp"
#include "servo/devices/sim/moving_mass.hpp"
#include "servo/devices/sim/sim_profile.hpp"

namespace spm::servo {

/// A simulated device in a hand. Time is counted in ticks: a force that answers the reading at a
/// tick acts from `delay_ticks` later on, 0 at once, and holds until the next one arrives.
struct PlantSettings {
  SimProfile profile = sim_profiles[0];
  double period = 1e-3;  ///< s, of a tick
  HandModel hand = HandModel::arm;
  MovingMass mass = MovingMass::constant;
  double delay_ticks = 0;  ///< 0 to longest_delay; a fraction acts within the tick
  /// s, standard deviation of the time at which a force arrives; never before its reading and never
  /// out of order
  double jitter = 0;
  /// 0 to 1, fraction of the ticks whose force never arrives: the last one holds
  double lost_share = 0;
  double friction_scale = 1;  ///< factor of the profile's Coulomb friction
  double encoder_step = -1;   ///< m; 0: none; below 0: the profile's
  double noise = 0;  ///< m, standard deviation for each tick and axis, before the encoder's step
  std::uint64_t seed = 1;
  int substeps = 20;  ///< a tick, at least 1; Coulomb friction and a lag need 20
};

/// Number of substeps for a tick of `period` s: at least 20, and none longer than 50 us.
[[nodiscard]] int substeps_for(double period) noexcept;

/// What happened in a tick. Forces are means over the tick, of true forces; work is over the true
/// motion.
struct PlantTick {
  Vector3 hand_force = Vector3::Zero();      ///< N, of the hand on the tool
  Vector3 actuator_force = Vector3::Zero();  ///< N, of the actuators on the tool
  double work = 0;                           ///< J, of the actuators on the tool
  double hand_work = 0;                      ///< J, of the hand on the tool
  double target_work = 0;  ///< J, put into the hand's springs and dampers by moving the target
  double loss = 0;         ///< J, in the device's damping and friction
  double hand_loss = 0;    ///< J, in the hand's dampers
};

/// Energy that is stored, J.
struct PlantEnergy {
  double tool = 0;  ///< kinetic, of the tool
  double hand = 0;  ///< kinetic, of the arm, and of the hand's springs
};

/// A device's tool in a hand, integrated in substeps of a tick by the implicit midpoint rule, which
/// conserves energy exactly while the mass is constant. Coulomb friction sticks: a tool at rest
/// stays until the other forces exceed it. No allocation after construction. The same settings and
/// forces give the same ticks.
class SimPlant {
 public:
  explicit SimPlant(const PlantSettings& settings) noexcept;

  /// Puts tool, arm and target at a position (m), all at rest, with no force on its way.
  void place(const Vector3& position) noexcept;

  /// The position as the encoders read it, m: with the tick's noise, rounded to their step.
  [[nodiscard]] Vector3 measured_position() const noexcept;

  [[nodiscard]] const Vector3& position() const noexcept { return position_; }
  [[nodiscard]] const Vector3& velocity() const noexcept { return velocity_; }
  [[nodiscard]] const Vector3& arm_position() const noexcept { return arm_position_; }
  [[nodiscard]] const Vector3& arm_velocity() const noexcept { return arm_velocity_; }
  [[nodiscard]] PlantEnergy energy() const noexcept;
  [[nodiscard]] const PlantSettings& settings() const noexcept { return settings_; }

  /// Advances by one tick. `commanded` (N) answers the reading at the tick's beginning. The target
  /// moves at constant speed to its position at the tick's end.
  PlantTick step(const Vector3& commanded, const HandTarget& target) noexcept;

  /// The same, but the hand is as strong as necessary to take the tool at constant speed to a
  /// position (m) during the tick. Its force counts as the hand's, and there is no arm.
  PlantTick carry(const Vector3& commanded, const Vector3& to) noexcept;

 private:
  /// The hand's springs and dampers; a part that is absent is 0.
  struct Hand {
    double grip_stiffness, grip_damping;  ///< N/m, N s/m, between the tool and the next
    double arm_mass, stiffness, damping;  ///< kg, N/m, N s/m, from the arm to the target
  };

  /// The motion of all parts at the beginning of a substep.
  struct Moment {
    Vector3 position, velocity, arm_position, arm_velocity;
  };

  [[nodiscard]] static Hand hand_of(HandModel model) noexcept;
  void draw_noise() noexcept;
  void begin_tick() noexcept;
  void substep(const Vector3& actuator, const HandTarget& wanted, PlantTick& tick) noexcept;
  void account(const Moment& before, const Vector3& actuator, const Vector3& rubbing,
               const HandTarget& wanted, PlantTick& tick) const noexcept;
  [[nodiscard]] Vector3 rubbed(const Vector3& push, double added) const noexcept;

  PlantSettings settings_;
  Hand hand_;
  double step_;      ///< s, of a substep
  double friction_;  ///< N
  ActuatorLine line_;
  Random noise_source_;
  Eigen::Matrix3d mass_;                  ///< kg
  Eigen::Matrix3d mass_axes_;             ///< principal directions, in columns
  Vector3 principal_masses_;              ///< kg
  Vector3 gyroscopic_ = Vector3::Zero();  ///< N
  Vector3 position_ = Vector3::Zero();
  Vector3 velocity_ = Vector3::Zero();
  Vector3 arm_position_ = Vector3::Zero();
  Vector3 arm_velocity_ = Vector3::Zero();
  Vector3 target_ = Vector3::Zero();  ///< m, at the end of the last tick
  Vector3 noise_ = Vector3::Zero();   ///< m, of the present reading
};

}  // namespace spm::servo
