// SPDX-License-Identifier: GPL-3.0-or-later
// A peg in a hole, whose ticks have time for few looks at the contact.
#include <algorithm>
#include <array>
#include <catch2/catch.hpp>
#include <cmath>
#include <cstdint>
#include <numbers>

#include "servo/force/sampled_tool.hpp"
#include "servo/force/scene_force.hpp"
#include "tests/bench/base/unwrap.hpp"
#include "tests/stability/sixdof/sixdof_scene.hpp"

namespace spm::stability::sixdof_short_time_test {
namespace {

/// A clock that is put forward whenever it is read, so that time is as much as is done.
std::int64_t fake_now = 0;
std::int64_t fake_clock() noexcept { return fake_now += 400; }

constexpr double stiffness = 2000;  // N/m
constexpr double floor_depth = 4e-3;

/// The hand's place and turn: into the hole, to its floor, around its walls while it turns the peg,
/// and out.
HandPose hand_at(double t) {
  const auto leg = [](double from, double to, double s) {
    const double share = std::clamp(s, 0.0, 1.0);
    return from + (to - from) * (0.5 - 0.5 * std::cos(std::numbers::pi * share));
  };
  double z = leg(10e-3, -floor_depth, t / 0.4);
  if (t > 1.6) z = leg(-floor_depth, 12e-3, (t - 1.6) / 0.6);
  const double swing = std::clamp((t - 0.4) / 0.1, 0.0, 1.0) * std::clamp((2 - t) / 0.4, 0.0, 1.0);
  const double around = 2 * std::numbers::pi * (t - 0.4) / 0.6;
  HandPose hand;
  hand.position = {1.5e-3 * swing * std::cos(around), 1.5e-3 * swing * std::sin(around), z};
  const Vector3 turn(0.05 * swing * std::sin(2 * around), 0.04 * swing, 0.6 * std::sin(3 * t));
  hand.orientation = orientation_of(turn);
  return hand;
}

TEST_CASE("A peg follows the hand out of its hole, however little time its ticks have") {
  const SixdofCase tried = sixdof_case("peg-in-hole");
  const SixdofScene& scene = sixdof_scene(tried);
  const std::int64_t time = GENERATE(60'000, 150'000, 500'000);
  ForceScene forces;
  PlacedObject object;
  object.force.method = Method::proxy;
  object.force.stiffness = stiffness;
  object.effects.friction = {0.2, 0.15, stiffness};
  forces.objects = {object};
  forces.added = object;
  ToolSettings tool;
  tool.asset = 1;
  tool.coupling = stiffness;
  tool.spacing = 0.15e-3;
  forces.tool = tool;
  const auto sampled = bench::unwrap(SampledTool::make(scene.tool_asset(), tool, 1, 1));
  HandTurning turning;
  turning.reads = true;
  turning.torque_cap = 0.6;
  turning.force_cap = 12;
  SceneForce force(forces, 1e-3, 0, 0, FeltLimits{}, turning);
  force.take_tool(sampled.get(), 0);
  const std::array<const AssetView*, 2> assets{&scene.object().sparse(), &scene.tool_asset()};
  double most = 0, most_torque = 0;
  int degraded = 0;
  for (int tick = 0; tick < 2200; ++tick) {
    const double t = 1e-3 * tick;
    ForceBudget budget;
    budget.clock = &fake_clock;
    budget.until_ns = fake_now + time;
    const ContactForce found = force.next(assets, hand_at(t), 1, budget);
    degraded += force.effort().degraded() ? 1 : 0;
    if (t < 1.75) continue;
    most = std::max(most, found.force.norm());
    most_torque = std::max(most_torque, found.torque.norm());
  }
  INFO("in " << time << " ns: " << degraded << " ticks without time; pulled out with " << most
             << " N, " << most_torque << " N m");
  CHECK(degraded > 100);
  CHECK(most < 4);
  CHECK(most_torque < 0.15);
}

}  // namespace
}  // namespace spm::stability::sixdof_short_time_test
