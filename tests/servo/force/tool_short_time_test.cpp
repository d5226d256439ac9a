// SPDX-License-Identifier: Apache-2.0
// A tool that lies flat on an object, so that more samples touch than a tick has time for.
#include <algorithm>
#include <catch2/catch.hpp>
#include <cmath>
#include <cstdint>

#include "tests/servo/force/tool_scene.hpp"

namespace spm::tool_short_time_test {
namespace {

using test::ToolScene;

constexpr double rest = ToolScene::tool_size / 2;
constexpr double depth = 0.0004, slide = 0.3;  // 0.4 N press

/// A clock that is put forward whenever it is read, so that time is as much as is done.
std::int64_t fake_now = 0;
std::int64_t fake_clock() noexcept { return fake_now += 400; }

/// A tool that is pressed on the table within a time, and computed again without a clock.
class Short {
 public:
  Short() {
    for (ToolScene* scene : {&live_, &again_}) {
      scene->scene.objects[0].effects.friction = {slide, slide, 1000};
      scene->scene.tool->spacing = 0.0003;
      scene->begin();
    }
    for (int tick = 0; tick < 100; ++tick) {
      next({0, 0, rest + 0.0003 - std::min(1e-5 * tick, depth + 0.0003)}, 0, 10'000'000);
    }
  }
  ContactForce next(const Vector3& at, double angle, std::int64_t time) {
    ForceBudget budget;
    budget.clock = &fake_clock;
    budget.until_ns = fake_now + time;
    const HandPose hand{at, Eigen::Quaterniond(Eigen::AngleAxisd(angle, Vector3::UnitZ()))};
    ContactForce found = live_.force->next(live_.assets, hand, 1, budget);
    const ForceEffort effort = live_.force->effort();
    degraded_ += effort.degraded() ? 1 : 0;
    coarse_ += effort.level > 0 ? 1 : 0;
    const ContactForce replayed =
        again_.force->next(again_.assets, hand, 1, ForceBudget::again(effort));
    REQUIRE(found.force == replayed.force);
    REQUIRE(found.torque == replayed.torque);
    return found;
  }
  [[nodiscard]] const Eigen::Isometry3d& pose() const { return live_.force->tool().pose; }
  [[nodiscard]] int degraded() const { return degraded_; }
  [[nodiscard]] int coarse() const { return coarse_; }

 private:
  ToolScene live_, again_;
  int degraded_ = 0, coarse_ = 0;
};

// ns: as many readings as look once at the samples that touch, and a few more.
constexpr std::int64_t too_little = 250'000;

TEST_CASE(
    "A flat tool follows a hand that turns, with the torque of friction, in too little time") {
  Short tool;
  double most = 0, lag = 0;
  for (int tick = 0; tick < 600; ++tick) {
    const double angle = 0.001 * tick;  // 60 degrees a second
    const ContactForce found = tool.next({0, 0, rest - depth}, angle, too_little);
    most = std::max(most, found.torque.norm());
    const Eigen::AngleAxisd turned(tool.pose().linear());
    lag = std::max(lag, angle - turned.angle() * turned.axis().z());
  }
  CHECK(tool.degraded() > 300);
  // A square of 12 mm that turns on itself resists with 0.38 of its edge times friction.
  const double coulomb = 0.38 * ToolScene::tool_size * slide * 1000 * depth;
  INFO("torque " << most << " N m where Coulomb's is " << coulomb << ", lag " << lag << " rad");
  CHECK(most < 4 * coulomb);
  CHECK(most > coulomb / 4);
  CHECK(lag < 0.02);
}

TEST_CASE("A flat tool that is drawn aside is held by friction on coarser levels too") {
  Short tool;
  ContactForce found;
  double most = 0, least = 1e9;
  for (int tick = 0; tick < 400; ++tick) {
    found = tool.next({2e-5 * tick, 0, rest - depth}, 0, too_little);
    if (tick < 100) continue;
    const double share = -found.force.x() / found.force.z();
    most = std::max(most, share);
    least = std::min(least, share);
  }
  CHECK(tool.coarse() > 100);
  INFO("friction between " << least << " and " << most);
  CHECK(most < 2 * slide);
  CHECK(least > slide / 3);
}

}  // namespace
}  // namespace spm::tool_short_time_test
