// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <Eigen/Geometry>
#include <cstdint>
#include <span>

#include "common/sixdof/object_contact.hpp"

namespace spm {

struct VirtualToolSettings {
  double stiffness = 1000;  ///< of the coupling, N/m
  double turning = 1;       ///< N m/rad
  double max_force = 5;     ///< N, largest force of the coupling
  double max_torque = 0.1;  ///< N m
  double max_step =
      5e-5;  ///< m: largest motion of any place of the tool in a step where it may touch
  std::uint32_t steps = 12;  ///< largest number per tick
};

/// Result of a tick of the virtual tool.
struct VirtualToolReport {
  Wrench wrench;  ///< on the hand, about the device's origin, world frame
  Eigen::Isometry3d pose = Eigen::Isometry3d::Identity();  ///< of the virtual tool
  double energy = 0;  ///< J, in the springs and in the contact at that pose
  std::uint32_t steps = 0;
  bool balanced = false;        ///< the last step was shorter than a thousandth of the largest
  ObjectContactReport contact;  ///< at the last pose that was evaluated
};

/// Virtual coupling with a massless tool. Springs pull a virtual tool to the device's pose, and
/// contacts push it off the objects. Each tick moves it towards the balance of both, by damped
/// Newton steps on their energy; the hand feels the springs.
///
/// Near the objects the steps are so short that thin parts are met and not jumped over; elsewhere
/// they are as long as the clearance. That holds where the contact's stiffness balances
/// `max_force` on the few samples of an edge or corner before they are halfway through. The
/// stiffness may be high here, because there is no mass to oscillate. The force is bounded whatever
/// the objects do. A tick neither allocates nor throws.
class VirtualTool {
 public:
  /// `contact` must outlive this.
  VirtualTool(ObjectContact& contact, const VirtualToolSettings& settings, double tool_radius)
      : contact_(contact), settings_(settings), radius_(tool_radius) {}

  /// Puts the tool at a pose, where it should touch nothing.
  void place(const Eigen::Isometry3d& pose) noexcept { pose_ = pose; }

  /// One tick: the device is at `device`, whose position is the tool's origin. `budget` holds for
  /// each step separately. A pose that scales or is not finite moves nothing and gives no wrench.
  [[nodiscard]] VirtualToolReport tick(const Eigen::Isometry3d& device,
                                       std::span<const ContactObject> objects,
                                       const TickBudget& budget = {}) noexcept;

 private:
  /// The springs at a pose: wrench on the tool, how stiff they are there, and their energy.
  struct Coupling {
    Vector6 wrench = Vector6::Zero();
    double stiffness = 0, turning = 0, energy = 0;
  };

  ObjectContact& contact_;
  VirtualToolSettings settings_;
  double radius_;  ///< m: no place of the tool is farther from its origin
  Eigen::Isometry3d pose_ = Eigen::Isometry3d::Identity();

  [[nodiscard]] Coupling couple(const Eigen::Isometry3d& device,
                                const Eigen::Isometry3d& pose) const noexcept;
};

}  // namespace spm
