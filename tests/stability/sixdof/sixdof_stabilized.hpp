// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include "servo/force/braking_velocity.hpp"
#include "servo/force/passivity_control.hpp"
#include "servo/force/stabilizer.hpp"
#include "tests/stability/sixdof/sixdof_contestant.hpp"

namespace spm::stability {

/// The loop in which a wrench is stabilized.
struct SixdofLoop {
  double period = 1e-3;           ///< s
  double encoder_step = 0;        ///< m
  double turn_step = 0;           ///< rad
  double turning_inertia = 1e-4;  ///< kg m2, the least about any axis
};

/// The wrench of another force law, stabilized. Turns and torques are expressed as lengths and
/// forces at sixdof_lever. Matched damping brakes the place along the force and the turn about the
/// torque, each by its own stiffness. The passivity controller keeps one energy account for force
/// and torque together.
class StabilizedWrench final : public SixdofContestant {
 public:
  StabilizedWrench(std::unique_ptr<SixdofContestant> law, const StabilizationSettings& settings,
                   const SixdofLoop& loop);

  void begin(const Eigen::Isometry3d& start) override;
  [[nodiscard]] SixdofAnswer next(const Eigen::Isometry3d& measured) override;

 private:
  using Vector = WrenchPassivityControl::Vector;

  [[nodiscard]] Vector3 moved_to(const Eigen::Isometry3d& measured) noexcept;
  [[nodiscard]] Vector controlled(const Vector& wanted, const SixdofAnswer& answer) noexcept;

  std::unique_ptr<SixdofContestant> law_;
  bool controls_;
  Stabilizer forces_, torques_;  ///< damping alone
  WrenchPassivityControl passivity_;
  BrakingVelocity place_speed_, turn_speed_;
  Vector hand_ = Vector::Zero();  ///< place, and the sum of all small turns, m
  Eigen::Quaterniond orientation_ = Eigen::Quaterniond::Identity();
};

}  // namespace spm::stability
