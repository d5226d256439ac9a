// SPDX-License-Identifier: GPL-3.0-or-later
#include "tests/stability/sixdof/sixdof_handover.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <memory>
#include <vector>

#include "servo/force/sampled_tool.hpp"
#include "servo/force/scene_force.hpp"
#include "tests/bench/base/unwrap.hpp"
#include "tests/stability/laboratory/contestants.hpp"
#include "tests/stability/sixdof/sixdof_contestant.hpp"
#include "tests/stability/sixdof/sixdof_scene.hpp"

namespace spm::stability {

namespace {

constexpr double box_edge = 20e-3;         // m, edge of the object
constexpr double box_mass = 0.15;          // kg
constexpr double box_braking = 4;          // N s/m
constexpr double box_turn_braking = 2e-3;  // N m s/rad
constexpr double handed_way = 15e-3;       // m, that the object is handed over
constexpr double handover_seconds = 6, both_until = 3,
                 alone_from = 3.6;       // s; the second is alone from the last
constexpr double watched_seconds = 0.3;  // s

/// The object of the scene and the hands' tool, as a case that bakes and samples both.
SixdofCase handed_case() {
  SixdofCase made;
  made.name = "object-handed-over";
  made.title = "Two hands hand over an object that moves by what both do to it";
  made.tool = test::box({4e-3, 12e-3, 12e-3});
  made.object = test::box({box_edge, box_edge, box_edge});
  made.places = {Eigen::Isometry3d::Identity()};
  made.touch = pose_of({-(box_edge / 2 + 2e-3), 0, 0});
  made.press = Vector3::UnitX();
  made.normal = -Vector3::UnitX();
  return made;
}

/// Where a hand wants its tool along x at a time; `side` is -1 for the first hand, 1 for the
/// second.
double wanted(int side, double time) {
  const double touch = box_edge / 2 + 2e-3, away = touch + 10e-3;
  const auto ramp = [time](double from, double to, double begin, double end) {
    const double share = std::clamp((time - begin) / (end - begin), 0.0, 1.0);
    return from + share * (to - from);
  };
  if (side < 0) {
    // It pushes the object to the second, presses, and leaves.
    if (time < both_until) return ramp(-away, -touch + handed_way + 10e-3, 0.2, 1.2);
    return ramp(-touch + handed_way + 10e-3, -away - 20e-3, both_until, alone_from);
  }
  // The second waits where the object is brought to, and pushes it back once it is alone.
  if (time < alone_from) return touch + handed_way;
  return ramp(touch + handed_way, touch - 4e-3, alone_from, alone_from + 1);
}

/// A hand with its device and its forces.
class Hand {
 public:
  Hand(const SixdofCase& tried, const SixdofScene& scene, const ForceScene& forces,
       const RunSettings& settings, int side)
      : side_(side),
        settings_(settings),
        plant_(sixdof_settings(tried, settings)),
        assets_{&scene.object().sparse(), &scene.tool_asset()},
        tool_(bench::unwrap(SampledTool::make(scene.tool_asset(), *forces.tool, 1, 1))),
        force_(forces, settings.period, settings.profile->encoder_step, 0, {}, turning()) {
    force_.take_tool(tool_.get(), 0);
    plant_.place(pose_of(target(0).position));
  }

  /// A tick with the object at a pose; what the tool does to the object.
  Wrench tick(double time, const Eigen::Isometry3d& object) {
    const Eigen::Isometry3d measured = plant_.measured_pose();
    force_.place(0, object.translation(), Eigen::Quaterniond(object.linear()).normalized());
    const HandPose hand{measured.translation(), Eigen::Quaterniond(measured.linear()).normalized()};
    const ContactForce felt = force_.next(assets_, hand);
    const Wrench sent = plant_.reachable({felt.force, felt.torque});
    force_.sent(sent);
    deepest_ = std::max(deepest_, felt.depth);
    forces_.push_back(sent.force);
    plant_.step(sent, target(time + settings_.period));
    return force_.reaction(0);
  }

  [[nodiscard]] double deepest() const { return deepest_; }
  /// N RMS of the force over the time before a moment, its mean removed; and the mean, outward.
  [[nodiscard]] std::pair<double, double> ripple(double until) const {
    const auto end = static_cast<std::size_t>(std::lround(until / settings_.period));
    const auto first =
        end - static_cast<std::size_t>(std::lround(watched_seconds / settings_.period));
    Vector3 mean = Vector3::Zero();
    for (std::size_t i = first; i < end; ++i) mean += forces_[i];
    mean /= static_cast<double>(end - first);
    double squares = 0;
    for (std::size_t i = first; i < end; ++i) squares += (forces_[i] - mean).squaredNorm();
    return {std::sqrt(squares / static_cast<double>(end - first)), side_ * mean.x()};
  }

 private:
  [[nodiscard]] SixdofTarget target(double time) const {
    SixdofTarget target;
    // A little beside the middle, each hand to another side.
    target.position = Vector3(wanted(side_, time), side_ * 1e-3, 0);
    const double next = wanted(side_, time + settings_.period);
    target.velocity.x() = (next - target.position.x()) / settings_.period;
    return target;
  }
  [[nodiscard]] HandTurning turning() const {
    HandTurning turning;
    turning.reads = true;
    turning.torque_cap = plant_.torque_cap();
    turning.turn_step = plant_.turn_step();
    turning.inertia = plant_.inertia().minCoeff();
    turning.force_cap = settings_.profile->force_cap;
    return turning;
  }

  int side_;
  RunSettings settings_;
  SixdofPlant plant_;
  std::array<const AssetView*, 2> assets_;
  std::unique_ptr<SampledTool> tool_;
  SceneForce force_;
  double deepest_ = 0;
  std::vector<Vector3> forces_;
};

/// A free box in a medium, moved by wrenches that hold over a tick; its dampers are implicit.
class FreeBox {
 public:
  void step(const Wrench& wrench, double period) {
    velocity_ = (box_mass * velocity_ + period * wrench.force) / (box_mass + period * box_braking);
    const double inertia = box_mass * box_edge * box_edge / 6;
    rate_ = (inertia * rate_ + period * wrench.torque) / (inertia + period * box_turn_braking);
    pose_.translation() += period * velocity_;
    orientation_ = (orientation_of(period * rate_) * orientation_).normalized();
    pose_.linear() = orientation_.toRotationMatrix();
  }
  [[nodiscard]] const Eigen::Isometry3d& pose() const { return pose_; }
  [[nodiscard]] double turned() const {
    return turn_between(Eigen::Quaterniond::Identity(), orientation_).norm();
  }

 private:
  Eigen::Isometry3d pose_ = Eigen::Isometry3d::Identity();
  Eigen::Quaterniond orientation_ = Eigen::Quaterniond::Identity();
  Vector3 velocity_ = Vector3::Zero(), rate_ = Vector3::Zero();
};

}  // namespace

HandoverRun hand_over(const RunSettings& settings) {
  const SixdofCase tried = handed_case();
  const SixdofScene& scene = sixdof_scene(tried);
  const ForceScene forces = served_scene({"default", {}}, scene, tried, settings);
  Hand first(tried, scene, forces, settings, -1), second(tried, scene, forces, settings, 1);
  FreeBox object;
  HandoverRun run;
  const auto ticks = static_cast<std::size_t>(std::lround(handover_seconds / settings.period));
  for (std::size_t i = 0; i < ticks; ++i) {
    const double now = static_cast<double>(i) * settings.period;
    const Wrench a = first.tick(now, object.pose()), b = second.tick(now, object.pose());
    object.step({a.force + b.force, a.torque + b.torque}, settings.period);
    run.turned = std::max(run.turned, object.turned());
    if (now < both_until) run.brought = object.pose().translation().x();
  }
  run.taken = run.brought - object.pose().translation().x();
  run.ripple_both = std::max(first.ripple(both_until).first, second.ripple(both_until).first);
  run.ripple_end = second.ripple(handover_seconds).first;
  run.held = second.ripple(both_until).second;
  run.deepest = std::max(first.deepest(), second.deepest());
  return run;
}

}  // namespace spm::stability
