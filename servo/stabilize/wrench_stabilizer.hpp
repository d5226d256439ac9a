// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "common/base/hand_pose.hpp"
#include "common/base/wrench.hpp"
#include "servo/stabilize/passivity_control.hpp"
#include "servo/stabilize/stabilizer.hpp"

namespace spm {

/// The loop in which a wrench is stabilized; the hand's frame.
struct WrenchLoop {
  double tick = 1e-3;             ///< s, above 0
  double encoder_step = 0;        ///< m, 0 or more
  double turn_step = 0;           ///< rad, 0 or more
  double turning_inertia = 1e-4;  ///< kg m2, the least about any axis; above 0
  bool torque = true;             ///< whether the device gives torque
};

/// The energy that a wrench can give back, for the observer; of the hand.
struct WrenchEnergy {
  double stiffness = 0;  ///< N/m
  double turning = 0;    ///< N m/rad
  double stored = 0;     ///< J, in all springs
  double carried = 0;    ///< J, work on the hand since the last tick by objects that moved
};

/// The stabilization of a wrench, tick by tick: matched damping of the place along the force and of
/// the turn about the torque, each by its own stiffness, and one energy account for both. Turns and
/// torques are expressed as lengths and forces at turning_lever.
///
/// A device that reads six axes and pushes three gets no torque, and its account is of the place
/// alone. So energy that turning the hand puts into the springs, which the hand did not have to pay
/// for, counts as made by the loop, and the controller takes it back where it is let out by
/// translation. A tick allocates nothing and does not throw.
class WrenchStabilizer {
 public:
  WrenchStabilizer(const StabilizationSettings& settings, const WrenchLoop& loop) noexcept;

  /// The wrench to send, about the hand's position, when `wanted` is wanted with the hand at
  /// `hand`. The torque is zero for a device without. Never NaN: a pose or a wrench that is not
  /// finite gives zero, and all state is forgotten. `ticks`: since the last one.
  [[nodiscard]] Wrench apply(const Wrench& wanted, bool contact, const HandPose& hand,
                             const WrenchEnergy& energy, std::uint64_t ticks = 1) noexcept;

  /// Tells what was sent of the wrench that `apply` returned. Without it all of it counts as sent.
  void sent(const Wrench& wrench) noexcept;

  /// Forgets all state: at the start, and when what is felt was exchanged.
  void reset() noexcept;

  /// Energy that was generated and not taken back yet, J.
  [[nodiscard]] double generated() const noexcept {
    return loop_.torque ? both_.generated() : place_.generated();
  }

 private:
  using Vector = WrenchPassivityControl::Vector;

  void move_to(const HandPose& hand) noexcept;
  [[nodiscard]] Vector controlled(const Vector& wanted, const WrenchEnergy& energy) noexcept;

  WrenchLoop loop_;
  bool acts_, controls_;
  Stabilizer forces_, torques_;  ///< damping alone
  PassivityControl place_;       ///< without torque
  WrenchPassivityControl both_;
  BrakingVelocity place_speed_, turn_speed_;
  Vector hand_ = Vector::Zero();  ///< place, and the sum of all small turns at the lever, m
  Eigen::Quaterniond orientation_ = Eigen::Quaterniond::Identity();
  bool known_ = false;  ///< hand_ and orientation_ are those of the last tick
};

}  // namespace spm
