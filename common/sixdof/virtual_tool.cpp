// SPDX-License-Identifier: Apache-2.0
#include "common/sixdof/virtual_tool.hpp"

#include <Eigen/Cholesky>
#include <algorithm>
#include <cmath>

#include "common/base/rigid_pose.hpp"
#include "common/base/turn_between.hpp"

namespace spm {

namespace {

constexpr double balanced_share = 1e-3;
/// In balance the forces that are left are at most this part of the coupling's, and this many N.
constexpr double balanced_force = 0.01, least_force = 1e-3;
/// Near balance, at most this part: hardly more than the levels of the samples differ by.
constexpr double near_balance_force = 0.05;
/// Steps in a tick that are too short to be felt, and made for the balance of forces alone.
constexpr int most_fine_steps = 3;
/// Steps in a row that may fail and tell their planes, before a shorter one is tried.
constexpr int most_failures = 3;
/// After a step that raised the energy, this part of it is tried next.
constexpr double backtrack = 0.3;
/// Looks within this many of the longest steps are quick after the first.
constexpr double steps_ahead = 2;
/// A step takes up the planes of samples that are within this many of the longest steps.
constexpr double steps_near = 1.5;
/// After a tick in which all steps failed, one that raises the energy is taken where no sample is
/// deeper than this many of the longest steps after it: more than fields jump between their cells,
/// and less than any part is thick.
constexpr double bold_depth = 0.5;
/// J: a rise of the energy by less is rounding.
constexpr double energy_noise = 1e-12;

/// A spring whose force is capped: its secant stiffness at a stretch, and its energy.
struct CappedSpring {
  double stiffness, energy;
};
CappedSpring capped(double stiffness, double most, double stretch) noexcept {
  if (stiffness * stretch <= most) return {stiffness, stiffness * stretch * stretch / 2};
  return {most / stretch, most * (stretch - most / stiffness / 2)};
}

Eigen::Isometry3d moved(const Eigen::Isometry3d& pose, const Vector6& step) noexcept {
  Eigen::Isometry3d made = pose;
  made.translation() += step.head<3>();
  const Vector3 turn = step.tail<3>();
  const double angle = turn.norm();
  if (angle > 0) {
    // By way of a quaternion, so that rounding does not add up over many ticks.
    const Eigen::Quaterniond turned =
        Eigen::AngleAxisd(angle, turn / angle) * Eigen::Quaterniond(pose.linear());
    made.linear() = turned.normalized().toRotationMatrix();
  }
  return made;
}

}  // namespace

VirtualTool::Coupling VirtualTool::couple(const Eigen::Isometry3d& device,
                                          const Eigen::Isometry3d& pose) const noexcept {
  const Vector3 stretch = device.translation() - pose.translation();
  const Vector3 turn =
      turn_between(Eigen::Quaterniond(pose.linear()), Eigen::Quaterniond(device.linear()));
  const CappedSpring line = capped(settings_.stiffness, settings_.max_force, stretch.norm());
  const CappedSpring twist = capped(settings_.turning, settings_.max_torque, turn.norm());
  Coupling coupling;
  coupling.wrench << line.stiffness * stretch, twist.stiffness * turn;
  coupling.stiffness = line.stiffness;
  coupling.turning = twist.stiffness;
  coupling.energy = line.energy + twist.energy;
  coupling.capped = line.stiffness < settings_.stiffness || twist.stiffness < settings_.turning;
  return coupling;
}

/// What all looks of a tick have in common.
TickBudget VirtualTool::look_within(const VirtualToolBudget& budget) const noexcept {
  TickBudget look;
  look.ahead = steps_ahead * settings_.max_step;
  look.near = steps_near * settings_.max_step;
  look.as_points = true;
  look.finest_level = budget.finest_level;
  return look;
}

/// Looks at the contact where the tool is, as far as it is not known.
void VirtualTool::look_first(std::span<const ContactObject> objects,
                             const VirtualToolBudget& budget, VirtualToolReport& report) noexcept {
  if (known_ && budget.same_objects && looked_to_ == budget.finest_level) {
    report.contact = last_;
    if (!contact_->grip_moved()) return;
    if (contact_->grip_anew(report.contact.sum)) {
      report.looks = report.worked = 1;
      return;
    }
  }
  TickBudget look = look_within(budget);
  look.whole_levels = true;
  // A look is a piece of work itself, so that no two states of a tick have the same count.
  report.worked = 1;
  look.work = std::max(std::min(budget.refine_work, budget.work), 1U) - 1;
  if (std::min(budget.refine_work, budget.work) == VirtualToolBudget::unstopped) {
    look.work = VirtualToolBudget::unstopped;
  }
  if (budget.now != nullptr) {
    look.now = budget.now;
    look.nanoseconds = std::max<std::int64_t>(1, budget.refine_until - budget.now());
    look.anew = look.nanoseconds / 2;
  }
  report.contact = contact_->tick(pose_, objects, look);
  contact_->keep();
  ++report.looks;
  report.worked += report.contact.worked;
  looked_to_ = budget.finest_level;
  report.unresolved = report.contact.unresolved;
  if (report.contact.stopped) report.refine_stopped = report.worked;
}

/// The Newton step on the energy of springs and contact.
Vector6 VirtualTool::newton(const Trial& at) noexcept {
  Matrix6 stiffness = at.contact.sum.stiffness;
  stiffness.diagonal().head<3>().array() += at.coupling.stiffness;
  stiffness.diagonal().tail<3>().array() += at.coupling.turning;
  return stiffness.ldlt().solve(at.coupling.wrench + at.contact.sum.wrench);
}

/// The step to the least energy, as far as planes tell it of samples that are near.
Vector6 VirtualTool::best_step(const Trial& at) const noexcept {
  if (planes_.empty()) return newton(at);
  // Bristles and what else is no spring of a plane stay as they are.
  const ContactSum pressed = pressed_now(std::span(planes_).first(own_planes_));
  Matrix6 stiffness = at.contact.sum.stiffness - pressed.stiffness;
  stiffness.diagonal().head<3>().array() += at.coupling.stiffness;
  stiffness.diagonal().tail<3>().array() += at.coupling.turning;
  const Vector6 wrench = at.coupling.wrench + at.contact.sum.wrench - pressed.wrench;
  const double longest = 2 * std::max(settings_.max_step, at.contact.clearance);
  return contact_step(wrench, stiffness, planes_, longest, radius_);
}

/// Takes up the planes of near samples where the next step begins, if they are known.
void VirtualTool::take_planes() noexcept {
  planes_.clear();
  if (const std::vector<NearContact>* near = contact_->kept_near()) {
    planes_.assign(near->begin(), near->end());
  }
  own_planes_ = planes_.size();
}

/// Takes up the planes that a failed trial met, `step` from where the next one begins. False where
/// they are not known.
bool VirtualTool::learn_planes(const Vector6& step) noexcept {
  const std::vector<NearContact>* near = contact_->last_near();
  if (near == nullptr || contact_->kept_near() == nullptr) return false;
  const std::size_t before = planes_.size();
  for (const NearContact& contact : *near) {
    if (!(contact.distance < 0) || planes_.size() == planes_.capacity()) continue;
    NearContact& met = planes_.emplace_back(contact);
    auto distance = static_cast<double>(contact.distance);
    for (std::size_t k = 0; k < 6; ++k) {
      distance -= static_cast<double>(contact.along[k]) * step[static_cast<Eigen::Index>(k)];
    }
    met.distance = static_cast<float>(distance);
  }
  return planes_.size() > before;
}

/// Whether contact and springs are in balance, but for this part of the springs' forces. The
/// contact is so stiff that a step which is too short to be felt may still change its forces.
bool VirtualTool::in_balance(const Trial& at, double but_for) const noexcept {
  const Vector6 left = at.coupling.wrench + at.contact.sum.wrench;
  const double lever = std::max(radius_, 1e-9);
  const double size =
      at.coupling.wrench.head<3>().norm() + at.coupling.wrench.tail<3>().norm() / lever;
  return left.head<3>().norm() + left.tail<3>().norm() / lever <= but_for * size + least_force;
}

/// Whether there is time for a step, which may take as long as the last one did.
bool VirtualTool::begin_step(const VirtualToolBudget& budget, VirtualToolReport& report) noexcept {
  if (budget.now != nullptr) begun_ = budget.now();
  const bool late = budget.now != nullptr && budget.until - begun_ <= step_time_;
  if (!late && report.worked < budget.work) return true;
  report.stopped = report.worked;
  return false;
}

/// Looks at the contact of a trial's pose. False where there is no time to.
bool VirtualTool::look_at(Trial& trial, const Eigen::Isometry3d& device,
                          std::span<const ContactObject> objects, const VirtualToolBudget& budget,
                          VirtualToolReport& report) noexcept {
  TickBudget look = look_within(budget);
  look.same_levels = true;
  if (budget.now != nullptr) {
    look.now = budget.now;
    look.nanoseconds = std::max<std::int64_t>(1, budget.until - budget.now());
  }
  ++report.looks;
  ++report.worked;
  if (budget.work != VirtualToolBudget::unstopped) look.work = budget.work - report.worked;
  trial.coupling = couple(device, trial.pose);
  trial.contact = contact_->tick(trial.pose, objects, look);
  if (budget.now != nullptr) step_time_ = budget.now() - begun_;
  report.worked += trial.contact.worked;
  if (trial.contact.stopped) report.stopped = report.worked;
  return !trial.contact.stopped;
}

/// Tries a Newton step from a failed trial, back to contacts that the step did not know of. False
/// where there is no time to.
bool VirtualTool::correct(const Trial& tried, const Eigen::Isometry3d& device,
                          std::span<const ContactObject> objects, const VirtualToolBudget& budget,
                          double most, Trial& corrected, VirtualToolReport& report) noexcept {
  if (!begin_step(budget, report)) return false;
  Vector6 back = newton(tried);
  if (!back.allFinite()) back.setZero();
  const double far = length(back);
  if (far > most) back *= most / far;
  corrected.pose = moved(tried.pose, back);
  return look_at(corrected, device, objects, budget, report);
}

/// Steps to the least energy of springs and contact, as long as they lead on and there is time.
void VirtualTool::move(const Eigen::Isometry3d& device, std::span<const ContactObject> objects,
                       const VirtualToolBudget& budget, Coupling& coupling,
                       VirtualToolReport& report) noexcept {
  Trial now{pose_, coupling, report.contact};
  double limit_share = 1;
  int fine_steps = 0, failures = 0;
  bool bold = stuck_;
  stuck_ = true;
  const auto take = [&](const Trial& trial) {
    stuck_ = false;
    now = trial;
    contact_->keep();
    take_planes();
    limit_share = 1;
    failures = 0;
  };
  take_planes();
  if (budget.now != nullptr) {
    step_time_ = std::min(step_time_, std::max<std::int64_t>(0, budget.until - budget.now()) / 2);
  }
  while (report.steps < settings_.steps) {
    if (!begin_step(budget, report)) {
      report.balanced = in_balance(now, balanced_force);
      break;
    }
    Vector6 step = best_step(now);
    if (!step.allFinite()) break;
    const double far = length(step);
    const double clear = emerging_ ? 0 : now.contact.clearance;
    const double most = limit_share * std::max(settings_.max_step, std::min(clear, far));
    if (far > most) step *= most / far;
    if (std::min(far, most) < balanced_share * settings_.max_step &&
        (in_balance(now, balanced_force) || ++fine_steps > most_fine_steps)) {
      report.balanced = true;
      break;
    }
    ++report.steps;
    Trial tried{moved(now.pose, step), {}, {}};
    if (!look_at(tried, device, objects, budget, report)) break;
    const bool worse = tried.energy() > now.energy() + energy_noise;
    // The field is no part of a potential where it jumps, so that each way may seem to lead up.
    const bool dares = bold && tried.contact.sum.deepest <= bold_depth * settings_.max_step;
    if (!worse || dares || limit_share <= balanced_share) {
      bold = bold && !worse;
      take(tried);
      if (emerging_) break;
      continue;
    }
    if (failures++ < most_failures && learn_planes(step)) continue;
    if (contact_->last_near() == nullptr) {
      Trial corrected{};
      if (!correct(tried, device, objects, budget, most, corrected, report)) break;
      if (corrected.energy() <= now.energy() + energy_noise) {
        take(corrected);
        if (emerging_) break;
        continue;
      }
    }
    // A shorter one, whose first part is known.
    limit_share *= backtrack * std::min(1.0, far / most);
    failures = 0;
  }
  report.near_balance = report.balanced || in_balance(now, near_balance_force);
  stuck_ = stuck_ && report.steps > 0 && !report.balanced;
  pose_ = now.pose;
  coupling = now.coupling;
  report.contact = now.contact;
}

VirtualToolReport VirtualTool::tick(const Eigen::Isometry3d& device,
                                    std::span<const ContactObject> objects,
                                    const VirtualToolBudget& budget) noexcept {
  VirtualToolReport report;
  report.pose = pose_;
  if (!keeps_lengths(device)) {
    contact_->drop();
    known_ = false;
    return report;
  }
  Coupling coupling = couple(device, pose_);
  look_first(objects, budget, report);
  const bool coarse = report.contact.degraded;  // and so are the looks that follow
  emerging_ = emerging_ && report.contact.sum.deepest > settings_.max_step;
  move(device, objects, budget, coupling, report);
  last_ = report.contact;
  // What a coarser level told is looked at anew.
  known_ = !coarse && !report.contact.degraded;
  report.pose = pose_;
  report.capped = coupling.capped;
  report.energy = coupling.energy + report.contact.sum.energy;
  report.wrench = {-coupling.wrench.head<3>(), -coupling.wrench.tail<3>()};
  // The springs act at the tool's origin; the hand holds the device's.
  report.wrench.torque += (pose_.translation() - device.translation()).cross(report.wrench.force);
  return report;
}

}  // namespace spm
