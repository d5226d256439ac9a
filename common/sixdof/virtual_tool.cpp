// SPDX-License-Identifier: Apache-2.0
#include "common/sixdof/virtual_tool.hpp"

#include <Eigen/Cholesky>
#include <algorithm>
#include <cmath>

#include "common/base/rigid_pose.hpp"

namespace spm {

namespace {

constexpr double balanced_share = 1e-3;
/// After a step that raised the energy, this part of it is tried next.
constexpr double backtrack = 0.3;

/// The rotation from one orientation to another, as axis times angle, world frame.
Vector3 turn_between(const Eigen::Matrix3d& from, const Eigen::Matrix3d& to) noexcept {
  const Eigen::AngleAxisd turn(to * from.transpose());
  return turn.angle() * turn.axis();
}

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
  const Vector3 turn = turn_between(pose.linear(), device.linear());
  const CappedSpring line = capped(settings_.stiffness, settings_.max_force, stretch.norm());
  const CappedSpring twist = capped(settings_.turning, settings_.max_torque, turn.norm());
  Coupling coupling;
  coupling.wrench << line.stiffness * stretch, twist.stiffness * turn;
  coupling.stiffness = line.stiffness;
  coupling.turning = twist.stiffness;
  coupling.energy = line.energy + twist.energy;
  return coupling;
}

VirtualToolReport VirtualTool::tick(const Eigen::Isometry3d& device,
                                    std::span<const ContactObject> objects,
                                    const TickBudget& budget) noexcept {
  VirtualToolReport report;
  report.pose = pose_;
  if (!keeps_lengths(device)) return report;
  Coupling coupling = couple(device, pose_);
  report.contact = contact_.tick(pose_, objects, budget);
  double limit_share = 1;
  while (report.steps < settings_.steps) {
    ++report.steps;
    const ContactSum& contact = report.contact.sum;
    Matrix6 stiffness = contact.stiffness;
    stiffness.diagonal().head<3>().array() += coupling.stiffness;
    stiffness.diagonal().tail<3>().array() += coupling.turning;
    Vector6 step = stiffness.ldlt().solve(coupling.wrench + contact.wrench);
    const double far = step.head<3>().norm() + radius_ * step.tail<3>().norm();
    const double most =
        limit_share * std::max(settings_.max_step, std::min(report.contact.clearance, far));
    if (!step.allFinite()) break;
    if (far > most) step *= most / far;
    if (std::min(far, most) < balanced_share * settings_.max_step) {
      report.balanced = true;
      break;
    }
    const Eigen::Isometry3d tried = moved(pose_, step);
    const Coupling tried_coupling = couple(device, tried);
    const ObjectContactReport tried_contact = contact_.tick(tried, objects, budget);
    const double before = coupling.energy + contact.energy;
    const double after = tried_coupling.energy + tried_contact.sum.energy;
    if (after > before + 1e-12 && limit_share > balanced_share) {
      // There are contacts that the step did not know of. A shorter one is tried, whose first part
      // is known.
      limit_share *= backtrack * std::min(1.0, far / most);
      continue;
    }
    limit_share = 1;
    pose_ = tried;
    coupling = tried_coupling;
    report.contact = tried_contact;
  }
  report.pose = pose_;
  report.energy = coupling.energy + report.contact.sum.energy;
  report.wrench = {-coupling.wrench.head<3>(), -coupling.wrench.tail<3>()};
  // The springs act at the tool's origin; the hand holds the device's.
  report.wrench.torque += (pose_.translation() - device.translation()).cross(report.wrench.force);
  return report;
}

}  // namespace spm
