// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <Eigen/Geometry>
#include <cstdint>
#include <limits>
#include <span>
#include <vector>

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

/// Limits on a tick of the virtual tool, all of its steps together.
struct VirtualToolBudget {
  static constexpr std::uint32_t unstopped = std::numeric_limits<std::uint32_t>::max();

  std::int64_t (*now)() noexcept = nullptr;  ///< ns; null: time decides nothing
  std::int64_t refine_until = 0;             ///< of that clock: to look on finer levels
  std::int64_t until = 0;                    ///< of that clock: to begin and end steps
  /// The same, counted in samples as TickBudget does.
  std::uint32_t refine_work = unstopped;
  std::uint32_t work = unstopped;
  std::uint32_t finest_level = std::numeric_limits<std::uint32_t>::max();
  bool same_objects = false;  ///< none has moved or changed since the last tick
};

/// Result of a tick of the virtual tool.
struct VirtualToolReport {
  Wrench wrench;  ///< on the hand, about the device's origin, world frame
  Eigen::Isometry3d pose = Eigen::Isometry3d::Identity();  ///< of the virtual tool
  double energy = 0;  ///< J, in the springs and in the contact at that pose
  std::uint32_t steps = 0;
  std::uint32_t looks = 0;  ///< evaluations of the contact
  bool capped = false;      ///< the force or the torque of the springs met its largest
  /// The last step was shorter than a thousandth of the largest; or time was over in balance.
  bool balanced = false;
  /// What is left of the forces is at most a twentieth of the springs'.
  bool near_balance = false;
  ObjectContactReport contact;  ///< at that pose
  std::uint32_t worked = 0;     ///< samples, as VirtualToolBudget counts them
  /// Work after which time was over for finer levels, and for steps; `unstopped`: it was not.
  std::uint32_t refine_stopped = VirtualToolBudget::unstopped;
  std::uint32_t stopped = VirtualToolBudget::unstopped;
  /// Objects for which time was over on finer levels.
  std::uint32_t unresolved = 0;
};

/// Virtual coupling with a massless tool. Springs pull a virtual tool to the device's pose, and
/// contacts push it off the objects. Each tick moves it towards the balance of both, by steps to
/// the least energy as the planes of the field at near samples tell it; the hand feels the springs.
///
/// Near the objects the steps are so short that thin parts are met and not jumped over; elsewhere
/// they are as long as the clearance. That holds where the contact's stiffness balances
/// `max_force` on the few samples of an edge or corner before they are halfway through. The
/// stiffness may be high here, because there is no mass to oscillate. The force is bounded whatever
/// the objects do. A tool that is placed inside an object leaves it by one short step a tick.
///
/// When time is over the first look at the contact ends with the last level that it finished of
/// each object, and all further steps of the tick use the same levels, so that their energies can
/// be compared. A step that is not finished in time is not made, and none is begun that would take
/// longer than is left if it took as long as the last one; but at first half of the time is held to
/// suffice. A tick neither allocates nor throws.
class VirtualTool {
 public:
  /// `contact` must outlive this.
  VirtualTool(ObjectContact& contact, const VirtualToolSettings& settings, double tool_radius)
      : contact_(&contact), settings_(settings), radius_(tool_radius), planes_(contact.room()) {}

  /// Puts the tool at a pose, where it should touch nothing.
  void place(const Eigen::Isometry3d& pose) noexcept {
    pose_ = pose;
    emerging_ = true;
    known_ = stuck_ = false;
  }
  /// Moves it on from where it is: with an object that carries it.
  void carry(const Eigen::Isometry3d& pose) noexcept {
    pose_ = pose;
    known_ = stuck_ = false;
  }
  /// Whether it still leaves an object that it was placed in.
  [[nodiscard]] bool emerging() const noexcept { return emerging_; }
  /// May be changed between ticks.
  [[nodiscard]] VirtualToolSettings& settings() noexcept { return settings_; }

  /// One tick: the device is at `device`, whose position is the tool's origin. A pose that scales
  /// or is not finite moves nothing and gives no wrench.
  [[nodiscard]] VirtualToolReport tick(const Eigen::Isometry3d& device,
                                       std::span<const ContactObject> objects,
                                       const VirtualToolBudget& budget = {}) noexcept;

 private:
  /// The springs at a pose: wrench on the tool, how stiff they are there, and their energy.
  struct Coupling {
    Vector6 wrench = Vector6::Zero();
    double stiffness = 0, turning = 0, energy = 0;
    bool capped = false;
  };

  /// A pose that was looked at.
  struct Trial {
    Eigen::Isometry3d pose;
    Coupling coupling;
    ObjectContactReport contact;
    [[nodiscard]] double energy() const noexcept { return coupling.energy + contact.sum.energy; }
  };

  ObjectContact* contact_;
  VirtualToolSettings settings_;
  double radius_;  ///< m: no place of the tool is farther from its origin
  /// Planes of the contact where a step begins, then those that its failed trials met.
  std::vector<NearContact>& planes_;
  Eigen::Isometry3d pose_ = Eigen::Isometry3d::Identity();
  ObjectContactReport last_;     ///< of the last look that counted
  std::size_t own_planes_ = 0;   ///< number of those of `planes_` where the step begins
  std::int64_t begun_ = 0;       ///< when the last step was, ns
  std::int64_t step_time_ = 0;   ///< ns, that it took
  std::uint32_t looked_to_ = 0;  ///< the finest level that it was allowed
  bool emerging_ = false;        ///< it was placed, and may lie in an object
  bool known_ = false;           ///< `last_` is the contact at `pose_`
  bool stuck_ = false;           ///< in the last tick all steps failed

  [[nodiscard]] Coupling couple(const Eigen::Isometry3d& device,
                                const Eigen::Isometry3d& pose) const noexcept;
  [[nodiscard]] TickBudget look_within(const VirtualToolBudget& budget) const noexcept;
  [[nodiscard]] bool begin_step(const VirtualToolBudget& budget,
                                VirtualToolReport& report) noexcept;
  void look_first(std::span<const ContactObject> objects, const VirtualToolBudget& budget,
                  VirtualToolReport& report) noexcept;
  /// The farthest that a step moves any place of the tool, m.
  [[nodiscard]] double length(const Vector6& step) const noexcept {
    return step.head<3>().norm() + radius_ * step.tail<3>().norm();
  }
  [[nodiscard]] bool in_balance(const Trial& at, double but_for) const noexcept;
  [[nodiscard]] static Vector6 newton(const Trial& at) noexcept;
  [[nodiscard]] Vector6 best_step(const Trial& at) const noexcept;
  [[nodiscard]] bool correct(const Trial& tried, const Eigen::Isometry3d& device,
                             std::span<const ContactObject> objects,
                             const VirtualToolBudget& budget, double most, Trial& corrected,
                             VirtualToolReport& report) noexcept;
  void take_planes() noexcept;
  [[nodiscard]] bool learn_planes(const Vector6& step) noexcept;
  [[nodiscard]] bool look_at(Trial& trial, const Eigen::Isometry3d& device,
                             std::span<const ContactObject> objects,
                             const VirtualToolBudget& budget, VirtualToolReport& report) noexcept;
  void move(const Eigen::Isometry3d& device, std::span<const ContactObject> objects,
            const VirtualToolBudget& budget, Coupling& coupling,
            VirtualToolReport& report) noexcept;
};

}  // namespace spm
