// SPDX-License-Identifier: Apache-2.0

// What a hand felt of faults of the servo, and what it feels now (servo/safety/FAULTS.md). Prints a
// JSON object, whose keys end in their units.
//
// With SPM_BEFORE it compiles in the tree of commit 437b66a, the last before these faults were
// mended: copy it there, and link spm_servo_core and the test support as here. scripts/measure runs
// it for what is felt now.

#include <array>
#include <cmath>
#include <cstdio>
#include <nlohmann/json.hpp>

#include "servo/app/pose_interpolator.hpp"
#include "servo/force/scene_force.hpp"
#include "servo/safety/safety.hpp"
#include "servo/stabilize/passivity_control.hpp"
#include "servo/stabilize/velocity_estimate.hpp"
#include "tests/support/asset_by_hand.hpp"

namespace {

using namespace spm;
using namespace spm::servo;
using Assets = std::array<const AssetView*, 1>;
using Json = nlohmann::ordered_json;

constexpr double tick = 1e-3;  // s
constexpr double size = 0.04;  // m, of a cube about the origin
constexpr double half = size / 2;
constexpr double cap = 3000;     // N/m, as a Falcon has
constexpr double pressed = 5;    // N, of a hand before it lets go
constexpr double leaves = 0.02;  // m/s, of a hand that has let go
constexpr int frame = 17;        // ticks between two changes of an application at 60 Hz

/// The force of a tick of the stage, N, where `wanted` is what the force law wants.
Vector3 sent_of(SafetyStage& stage, const Vector3& wanted) {
  return stage.apply({wanted, Vector3::Zero()}, ForceOff::none).force;
}

SafetyStage engaged() {
  SafetyStage stage(safety_settings(12, 1000, 1 / tick));
  for (int i = 0; i < 200; ++i) static_cast<void>(sent_of(stage, {pressed, 0, 0}));
  return stage;
}

/// A material is changed. The stage of today does not learn of it.
void change_material([[maybe_unused]] SafetyStage& stage) {
#ifdef SPM_BEFORE
  stage.restart();
#endif
}

/// A material is changed once, and 10 ms later the hand lets go.
Json one_change() {
  SafetyStage stage = engaged();
  change_material(stage);
  for (int i = 0; i < 10; ++i) static_cast<void>(sent_of(stage, {pressed, 0, 0}));
  double most = 0, impulse = 0;
  int last = 0;
  for (int i = 0; i < 500; ++i) {
    const double sent = sent_of(stage, Vector3::Zero()).norm();
    most = std::max(most, sent);
    impulse += sent * tick;
    if (sent > 0) last = i + 1;
  }
  return {{"left_over_n", most}, {"left_over_ms", last}, {"left_over_n_s", impulse}};
}

/// A material is changed at 60 Hz all the time, and the hand lets go and moves off.
Json changes_at_60_hz() {
  SafetyStage stage = engaged();
  double energy = 0;
  int above = 0;
  for (int i = 0; i < 1000; ++i) {
    if (i % frame == 0) change_material(stage);
    // It presses until the first change is 10 ms old.
    const Vector3 wanted(i < 10 ? pressed : 0, 0, 0);
    const double sent = sent_of(stage, wanted).norm();
    if (i < 10) continue;
    energy += sent * leaves * tick;
    if (sent > 0.1 * pressed) above = i - 9;
  }
  return {{"above_a_tenth_ms", above}, {"energy_j", energy}};
}

PlacedObject object_of(Method method, double stiffness) {
  PlacedObject object;
  object.force.method = method;
  object.force.stiffness = stiffness;
  return object;
}

#ifdef SPM_BEFORE
SceneForce scene_force(const ForceScene& scene) { return {scene, tick, 0, 0, cap}; }
#else
/// With what a Falcon bears.
SceneForce scene_force(const ForceScene& scene) {
  const DeviceProfile* falcon = find_device_profile("falcon");
  return {scene, tick, 0, 0, felt_limits({falcon, falcon->stiffness_cap}, tick)};
}
#endif

/// Sixty objects in one place, each as stiff as the device may be.
double stacked() {
  const test::SparseCubeByHand cube(size);
  ForceScene scene;
  scene.objects.assign(60, object_of(Method::spm, cap));
  SceneForce force = scene_force(scene);
  constexpr double depth = 1e-4;
  return force.next(Assets{&cube.view}, {0.001, 0.003, half - depth}).force.z() / depth;
}

/// A hand that slides at 0.1 m/s over an object with a damping of 1000 N s/m.
double damped() {
  const test::SparseCubeByHand cube(size);
  PlacedObject object = object_of(Method::spm, 1000);
  object.effects.damping = 1000;
  SceneForce force = scene_force({{}, {object}});
  Vector3 found = Vector3::Zero();
  for (int i = 0; i < 50; ++i) {
    found = force.next(Assets{&cube.view}, {-0.01 + 1e-4 * i, 0.003, half - 0.001}).force;
  }
  return std::abs(found.x());
}

/// A hand above a plate of 1 mm presses past its middle, and what it feels is changed.
Json past_the_middle() {
  const test::SparseCubeByHand plate(0.001, {0.0005, 0.0005});
  const Assets assets{&plate.view};
  const Vector3 above(0.0001, 0.0001, 0.0006), below(0.0001, 0.0001, -0.0003);
  SceneForce force({{}, {object_of(Method::proxy, 1000)}}, tick, 0);
  for (int i = 0; i < 100; ++i) (void)force.next(assets, above + i / 99.0 * (below - above));
  const double held = force.next(assets, below).force.z();
  force.change(0, object_of(Method::proxy, 1500));
  return {{"held_n", held}, {"after_change_n", force.next(assets, below).force.z()}};
}

/// Velocity that is told of a hand at 0.2 m/s, of which the loop skipped five ticks.
double skipped() {
  VelocityEstimate estimate(20e-6, tick);
  for (int i = 0; i <= 10; ++i) (void)estimate.next({2e-4 * i, 0, 0});
#ifdef SPM_BEFORE
  return estimate.next({2e-4 * 16, 0, 0}).x();
#else
  return estimate.next({2e-4 * 16, 0, 0}, 6).x();
#endif
}

/// Energy that is counted as generated by a force that was wanted and not sent.
double not_sent() {
  PassivityControl control({0, tick, 0, 0.1});
  for (int i = 0; i < 10; ++i) {
    (void)control.next({0, 0, 1}, Vector3(0, 0, 1e-4 * i), {0, 0, 0.1}, 1000, 0, 0);
#ifndef SPM_BEFORE
    control.sent(Vector3::Zero());
#endif
  }
  return control.generated();
}

/// Speed of a place of an object, 0.5 m from its origin, that an application turns by 3 rad.
double turned() {
  const Vector3 corner(0.5, 0, 0);
  PoseInterpolator object({}, {});
#ifndef SPM_BEFORE
  object.set_reach(corner.norm(), 0);
#endif
  Placement pose;
  pose.rotation = Eigen::Quaterniond(Eigen::AngleAxisd(3, Vector3::UnitZ()));
  constexpr std::int64_t tick_ns = 1'000'000;
  object.give(pose, 0.01, tick_ns);
  double most = 0;
  Vector3 before = corner;
  for (std::int64_t i = 1; i < 5000; ++i) {
    const Vector3 now = object.at(i * tick_ns).pose.to_world(corner);
    most = std::max(most, (now - before).norm() / tick);
    before = now;
  }
  return most;
}

}  // namespace

int main() {
  const Json found{{"one_change", one_change()},
                   {"changes_at_60_hz", changes_at_60_hz()},
                   {"stacked_n_m", stacked()},
                   {"damping_n", damped()},
                   {"past_the_middle", past_the_middle()},
                   {"skipped_m_s", skipped()},
                   {"not_sent_j", not_sent()},
                   {"turned_m_s", turned()}};
  std::puts(found.dump().c_str());
  return 0;
}
