// SPDX-License-Identifier: GPL-3.0-or-later
#include "tests/bench/sixdof/served_tool.hpp"

#include <chrono>
#include <utility>

#include "baker/base/bake_error.hpp"
#include "servo/force/pressed_part.hpp"

namespace spm::bench {
namespace {

constexpr double served_period = 1e-3;  // s
/// The law of method `spm` is judged by its forces, which a cap would bend.
constexpr double never_met = 1e6;  // N, N m
/// Of method `proxy` the caps are a device's, since it makes the contact's stiffness of them.
constexpr double device_force = 12;    // N
constexpr double device_torque = 0.6;  // N m

std::int64_t now_ns() noexcept {
  return std::chrono::duration_cast<std::chrono::nanoseconds>(
             std::chrono::steady_clock::now().time_since_epoch())
      .count();
}

}  // namespace

ServedTool::ServedTool(const BakedObject& tool, const BakedObject& object, double spacing,
                       Method method, double area_stiffness, double limit)
    : assets_{&object.view(), &tool.view()}, limit_(limit) {
  ToolSettings settings;
  settings.asset = 1;
  settings.spacing = spacing;
  auto made = SampledTool::make(tool.view(), settings, 1, 1);
  if (!made) throw baker::BakeError(made.error().code, made.error().message);
  sampled_ = std::move(*made);
  PlacedObject placed;
  placed.force.method = method;
  placed.force.stiffness = method == Method::spm
                               ? area_stiffness * pressed_part * sampled_->samples().area
                               : ForceSettings{}.stiffness;
  scene_.objects = {placed};
  scene_.added = placed;
  scene_.tool = settings;
  begin();
}

void ServedTool::begin() {
  HandTurning turning;
  turning.reads = true;
  const bool proxy = scene_.objects.front().force.method == Method::proxy;
  turning.force_cap = proxy ? device_force : never_met;
  turning.torque_cap = proxy ? device_torque : never_met;
  force_ = std::make_unique<SceneForce>(scene_, served_period, 0.0, 0, FeltLimits{}, turning);
  force_->take_tool(sampled_.get(), 0);
  if (proxy) return;
  // It comes from outside: what begins deep inside is led out, and does not press.
  HandPose outside;
  outside.position = Vector3::UnitX();
  static_cast<void>(force_->next(assets_, outside, 1, {}));
}

Wrench ServedTool::ask(const Eigen::Isometry3d& pose) {
  ForceBudget budget;
  if (limit_ > 0) {
    budget.clock = &now_ns;
    budget.until_ns = now_ns() + static_cast<std::int64_t>(1e9 * limit_);
  }
  const HandPose hand{pose.translation(), Eigen::Quaterniond(pose.linear())};
  const ContactForce contact = force_->next(assets_, hand, 1, budget);
  return {contact.force, contact.torque};
}

}  // namespace spm::bench
