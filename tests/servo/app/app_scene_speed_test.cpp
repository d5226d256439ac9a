// SPDX-License-Identifier: Apache-2.0
// How fast the surface of an object may come at a hand, whatever an application asks for.
#include <algorithm>
#include <catch2/catch.hpp>
#include <cmath>
#include <memory>

#include "servo/app/app_scene.hpp"
#include "servo/client/state_reader.hpp"
#include "tests/servo/support/loop_stand_in.hpp"

namespace app_scene_speed_test {

using namespace spm;
using namespace spm::servo;
using namespace spm::test;

namespace {

constexpr std::int64_t tick_ns = 1'000'000;
/// From the asset's origin to the corner of its box that is farthest from it, m.
const Vector3 corner(0.3, 0.4, 0);

/// A scene of one object that may be moved, ticked at 1 kHz.
class Turned {
 public:
  explicit Turned(double scale) {
    scene_.objects.front().movable = true;
    scene_.objects.front().placement.scale = scale;
    force_ = std::make_unique<SceneForce>(scene_, 1e-3, 1e-6, AppScene::room(scene_));
    app_ = std::make_unique<AppScene>(*state_, scene_);
    state_->rings()[0].offer(ring_.attached());
    tick();
  }

  void know_reach() { app_->set_reach(0, corner.norm()); }
  /// Asks for the object to be turned by an angle about z, and moved to x.
  void send(double angle, double x) {
    spm_shared_command command = move_command(0, x);
    command.orientation[0] = std::cos(angle / 2);
    command.orientation[3] = std::sin(angle / 2);
    command.period = 0.01;
    ring_.write(command);
  }
  void tick() {
    SceneForce* const forces[] = {force_.get()};
    now_ns_ += tick_ns;
    static_cast<void>(app_->begin(now_ns_, forces));
    app_->end(1, now_ns_, {}, forces);
  }
  /// Where the object lies.
  [[nodiscard]] Placement placed() const {
    const auto& shared = *static_cast<const spm_shared_state*>(state_->memory().data());
    Placement found;
    REQUIRE(read_newest(shared, [&found](const auto& snapshot) {
              const spm_shared_object& from = snapshot.objects[0];
              const double* const q = from.orientation;
              found.position = {from.position[0], from.position[1], from.position[2]};
              found.rotation = Eigen::Quaterniond(q[0], q[1], q[2], q[3]);
              found.scale = from.scale;
              return true;
            }) == ReadResult::fine);
    return found;
  }
  /// Runs until the object lies still; the largest speed of the corner on the way, m/s.
  [[nodiscard]] double fastest() {
    double most = 0;
    Placement before = placed();
    for (int i = 0; i < 5000; ++i) {
      tick();
      const Placement now = placed();
      most = std::max(most, (now.to_world(corner) - before.to_world(corner)).norm() / 1e-3);
      before = now;
    }
    return most;
  }

 private:
  ForceScene scene_ = scene_of({});
  std::unique_ptr<AppState> state_ = small_state();
  RawRing ring_{1};
  std::unique_ptr<SceneForce> force_;
  std::unique_ptr<AppScene> app_;
  std::int64_t now_ns_ = 0;
};

}  // namespace

TEST_CASE("No place of an object comes faster than a metre a second, however far out it is") {
  for (const double scale : {0.1, 1.0, 3.0}) {
    for (const double x : {0.0, -0.2, 0.2}) {
      Turned object(scale);
      object.know_reach();
      object.send(3, x);
      const double fastest = object.fastest();
      CAPTURE(scale, x, fastest);
      CHECK(fastest <= 1 + 1e-6);
      // It arrives all the same.
      CHECK(object.placed().rotation.angularDistance(
                Eigen::Quaterniond(Eigen::AngleAxisd(3, Vector3::UnitZ()))) < 1e-6);
    }
  }
}

TEST_CASE("An asset that comes while its object turns slows the object from there on") {
  Turned object(1);
  object.send(3, 0);
  for (int i = 0; i < 20; ++i) object.tick();
  object.know_reach();
  const Placement there = object.placed();
  object.tick();
  // It goes on from where it is.
  CHECK(object.placed().rotation.angularDistance(there.rotation) <= 0.01 + 1e-6);
  CHECK(object.fastest() <= 1 + 1e-6);
}

}  // namespace app_scene_speed_test
