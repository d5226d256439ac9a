// SPDX-License-Identifier: Apache-2.0
#include "servo/stabilize/wrench_stabilizer.hpp"

#include <algorithm>
#include <catch2/catch.hpp>
#include <cmath>
#include <limits>
#include <utility>

#include "tests/servo/force/tool_scene.hpp"

namespace spm::wrench_stabilizer_test {
namespace {

using test::ToolScene;

constexpr double rest = ToolScene::tool_size / 2;
constexpr double turn = 0.4, lift = 0.003;
constexpr int ticks_turning = 100, ticks_lifting = 30;

/// Carries the hand along one leg, and returns the work of force and of torque on it, J.
struct Worker {
  ToolScene& scene;
  Vector3 position{0, 0, rest + 0.0005};
  double angle = 0;
  double by_force = 0, by_torque = 0;

  void go(double up, double turned, int ticks) {
    for (int tick = 0; tick < ticks; ++tick) {
      const Eigen::Quaterniond pose(Eigen::AngleAxisd(angle, Vector3::UnitY()));
      const ContactForce contact = scene.next(position, pose);
      position.z() += up / ticks;
      angle += turned / ticks;
      by_force += contact.force.z() * up / ticks;
      by_torque += contact.torque.y() * turned / ticks;
    }
  }
};

/// Ten times: turned into the table, lifted out, turned back, lowered. The work of the force on the
/// hand, and of the torque, J.
Worker closed_path(ToolScene& scene) {
  scene.begin();
  Worker worker{scene};
  worker.go(0, 0, 20);
  worker.by_force = worker.by_torque = 0;
  for (int round = 0; round < 10; ++round) {
    worker.go(0, turn, ticks_turning);
    worker.go(lift, 0, ticks_lifting);
    worker.go(0, -turn, ticks_turning);
    worker.go(-lift, 0, ticks_lifting);
  }
  return worker;
}

StabilizationSettings account_alone() {
  StabilizationSettings made;
  made.passivity = true;
  made.delay_ticks = 0;
  return made;
}

TEST_CASE(
    "What a hand gains by lifting a tool it has paid for by turning it, where it feels both") {
  ToolScene scene;
  const Worker worker = closed_path(scene);
  CHECK(worker.by_force > 1e-3);
  // The force is a potential's, up to a tick's steps.
  CHECK(worker.by_force + worker.by_torque < 0.25 * worker.by_force);
}

TEST_CASE("A device that pushes three axes does not give back what turning put into the springs") {
  ToolScene bare, stabilized;
  for (ToolScene* scene : {&bare, &stabilized}) scene->turning.torque_cap = 0;
  stabilized.scene.stabilization = account_alone();
  const Worker without = closed_path(bare);
  const Worker with = closed_path(stabilized);
  CHECK(without.by_torque == 0);
  CHECK(with.by_torque == 0);
  // The hand turned for nothing, so what the force gives is made by the loop.
  CHECK(without.by_force > 3e-3);
  CHECK(with.by_force < 0.25 * without.by_force);
  // The tool itself is still told.
  CHECK(stabilized.force->tool().pose.translation().allFinite());
}

TEST_CASE("A wrench is left as it is where no stabilization is on, and zero where it is none") {
  WrenchStabilizer stabilizer({}, {});
  const Wrench wrench{{1, 2, 3}, {0.1, 0.2, 0.3}};
  const Wrench same = stabilizer.apply(wrench, true, {}, {1000, 1, 0, 0});
  CHECK(same.force == wrench.force);
  CHECK(same.torque == wrench.torque);
  StabilizationSettings on = recommended_stabilization;
  WrenchStabilizer acting(on, {});
  const double nan = std::numeric_limits<double>::quiet_NaN();
  CHECK(acting.apply({{nan, 0, 0}, {0, 0, 0}}, true, {}, {1000, 1, 0, 0}).force.isZero());
  WrenchLoop three;
  three.torque = false;
  WrenchStabilizer pushing(on, three);
  CHECK(pushing.apply(wrench, true, {}, {1000, 1, 0, 0}).torque.isZero());
}

TEST_CASE("Matched damping brakes the place along the force and the turn about the torque") {
  StabilizationSettings settings;
  settings.damping_share = 1;
  WrenchStabilizer stabilizer(settings, {});
  Wrench found;
  HandPose hand;
  for (int tick = 0; tick < 50; ++tick) {
    hand.position.z() -= 1e-4;
    hand.orientation = Eigen::Quaterniond(Eigen::AngleAxisd(-1e-3 * tick, Vector3::UnitX()));
    found = stabilizer.apply({{0, 0, 3}, {0.2, 0, 0}}, true, hand, {1000, 1, 0, 0});
  }
  // Against the motion: 0.1 m/s downwards, 1 rad/s about -x.
  CHECK(found.force.z() == Approx(3 + 0.1 * 1000 * 1.5e-3).epsilon(1e-6));
  CHECK(found.torque.x() == Approx(0.2 + 1.0 * 1 * 1.5e-3).epsilon(1e-3));
}

TEST_CASE("A hand that rests by one encoder step is not braked, however soft the other part is") {
  StabilizationSettings account = account_alone();
  WrenchLoop loop;
  loop.encoder_step = 64e-6;
  loop.turn_step = 1e-3;
  // Stiff along and soft about, and the other way round; N/m, and N m/rad.
  for (const auto& [stiff, turning] : {std::pair{1000.0, 1e-3}, {1.0, 1.0}}) {
    CAPTURE(stiff, turning);
    WrenchStabilizer stabilizer(account, loop);
    double largest = 0;
    for (int i = 0; i < 1000; ++i) {
      const int off = i % 7 < 3 ? 1 : 0;
      HandPose hand;
      hand.position.z() = -1e-3 - off * loop.encoder_step;
      const double angle = -0.01 - off * loop.turn_step;
      hand.orientation = Eigen::Quaterniond(Eigen::AngleAxisd(angle, Vector3::UnitX()));
      const double depth = -hand.position.z();
      const Wrench wanted{{0, 0, stiff * depth}, {-turning * angle, 0, 0}};
      const double stored = (stiff * depth * depth + turning * angle * angle) / 2;
      const Wrench sent = stabilizer.apply(wanted, true, hand, {stiff, turning, stored, 0});
      if (i < 50) continue;
      largest = std::max({largest, (sent.force - wanted.force).norm(),
                          (sent.torque - wanted.torque).norm() / 0.03});
    }
    CHECK(largest < 0.01);
    CHECK(stabilizer.generated() < 1e-7);
  }
}

}  // namespace
}  // namespace spm::wrench_stabilizer_test
