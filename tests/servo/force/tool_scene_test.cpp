// SPDX-License-Identifier: Apache-2.0
// A tool among the objects of a scene: friction, texture, damping, objects that move, budgets.
#include "tests/servo/force/tool_scene.hpp"

#include <catch2/catch.hpp>
#include <cmath>
#include <cstdint>
#include <cstring>
#include <limits>
#include <vector>

#include "tests/support/random.hpp"

namespace spm::tool_scene_test {
namespace {

using test::RandomTwister;
using test::ToolScene;

constexpr double rest = ToolScene::tool_size / 2;

Eigen::Quaterniond turned(double angle, const Vector3& axis) {
  return Eigen::Quaterniond(Eigen::AngleAxisd(angle, axis.normalized()));
}

/// A tool on a table that is pulled aside and turned about the vertical, by less than friction
/// holds, for so many ticks.
void rest_on_table(int ticks) {
  ToolScene scene;
  scene.scene.objects[0].effects.friction = {0.6, 0.5, 1000};
  scene.begin();
  scene.settle({0, 0, rest + 0.0003}, Eigen::Quaterniond::Identity(), 20);
  scene.settle({0, 0, rest - 0.002});
  // Pulled aside with 0.5 N and turned about the vertical, while 2 N press.
  const Vector3 pulled(0.0005, 0, rest - 0.002);
  const Eigen::Quaterniond twisted = turned(0.002, Vector3::UnitZ());
  scene.settle(pulled, twisted);
  const Eigen::Isometry3d held = scene.force->tool().pose;
  ContactForce contact;
  RandomTwister random(5);
  for (int tick = 0; tick < ticks; ++tick) {
    // Readings of an encoder.
    contact = scene.next(pulled + random.vector(1e-5), twisted);
  }
  CHECK((scene.force->tool().pose.translation() - held.translation()).head<2>().norm() < 2e-5);
  CHECK(Eigen::AngleAxisd(scene.force->tool().pose.linear() * held.linear().transpose()).angle() <
        1e-3);
  CHECK(contact.force.x() == Approx(-0.5).margin(0.05));
  CHECK(contact.torque.z() < -5e-4);
}

// The minute of the next case takes ten seconds and more, so that ten seconds are tried each time.
// The laboratory's case `tool-rests-a-minute` is of a minute always.
TEST_CASE("A tool that rests on a table does neither creep nor spin while friction holds it") {
  rest_on_table(10000);
}

TEST_CASE("A tool that rests on a table for a minute does neither creep nor spin", "[.long]") {
  rest_on_table(60000);
}

TEST_CASE("A tool that is dragged over a table slides by Coulomb's law") {
  ToolScene scene;
  scene.scene.objects[0].effects.friction = {0.6, 0.4, 1000};
  scene.begin();
  scene.settle({-0.005, 0, rest + 0.0003}, Eigen::Quaterniond::Identity(), 20);
  scene.settle({-0.005, 0, rest - 0.002});
  ContactForce contact;
  for (int tick = 0; tick < 250; ++tick)
    contact = scene.next({-0.005 + 3e-5 * tick, 0, rest - 0.002});
  CHECK(contact.force.z() == Approx(2).epsilon(0.05));
  CHECK(-contact.force.x() > 0.3 * contact.force.z());
  CHECK(-contact.force.x() < 0.65 * contact.force.z());
}

TEST_CASE("Without friction a tool slides, and damping brakes it by its velocity") {
  for (const double damping : {0.0, 5.0}) {
    ToolScene scene;
    scene.scene.objects[0].effects.damping = damping;
    scene.begin();
    scene.settle({-0.005, 0, rest + 0.0003}, Eigen::Quaterniond::Identity(), 20);
    ContactForce contact;
    for (int tick = 0; tick < 200; ++tick) {
      contact = scene.next({-0.005 + 5e-5 * tick, 0, rest - 0.002});
    }
    // 50 mm/s
    CHECK(contact.force.x() == Approx(-0.05 * damping).margin(0.02));
  }
}

TEST_CASE("Damping brakes a hand by how it moves along the object, which may move itself") {
  constexpr double damping = 5, step = 5e-5;  // 50 mm/s
  for (const bool turns : {false, true}) {
    for (const bool hand_moves : {false, true}) {
      ToolScene scene;
      scene.scene.objects[0].effects.damping = damping;
      scene.scene.objects[0].movable = true;
      scene.begin();
      scene.settle({-0.005, 0, rest + 0.0003}, Eigen::Quaterniond::Identity(), 20);
      scene.settle({-0.005, 0, rest - 0.002});
      ContactForce contact;
      for (int tick = 1; tick <= 100; ++tick) {
        // The table moves along x, or turns about the middle of its top by 10 rad/s.
        const double way = step * tick;
        const Vector3 middle(turns ? 0 : way, 0, -ToolScene::table_size / 2);
        const Eigen::Quaterniond turn = turned(turns ? 200 * way : 0, Vector3::UnitZ());
        scene.force->place(0, middle, turn);
        const Vector3 start(-0.005, 0, rest - 0.002);
        const Vector3 hand = turns ? turn * start : Vector3(start + Vector3(way, 0, 0));
        contact = hand_moves ? scene.next(hand, turn) : scene.next(start);
      }
      const Vector3 along = turns ? Vector3(0, -1, 0) : Vector3(1, 0, 0);
      const double still = hand_moves ? 0 : 0.05 * damping;
      INFO((turns ? "turns" : "moves") << ", hand " << hand_moves << ": " << contact.force);
      CHECK(contact.force.dot(along) == Approx(still).margin(0.03));
    }
  }
}

TEST_CASE("Texture is felt in six degrees: the same place feels the same") {
  ToolScene scene;
  scene.scene.objects[0].effects.texture = {200e-6, 2e-3, 3};
  scene.begin();
  const auto along = [&](std::vector<double>& heights) {
    for (int tick = 0; tick < 100; ++tick) {
      scene.settle({-0.004 + 8e-5 * tick, 0, rest - 0.002}, Eigen::Quaterniond::Identity(), 3);
      heights.push_back(scene.force->tool().pose.translation().z());
    }
  };
  scene.settle({-0.004, 0, rest + 0.0003}, Eigen::Quaterniond::Identity(), 20);
  std::vector<double> first, second;
  along(first);
  scene.settle({-0.004, 0, rest + 0.0005}, Eigen::Quaterniond::Identity(), 20);
  along(second);
  double spread = 0, off = 0;
  for (std::size_t i = 10; i < first.size(); ++i) {
    spread = std::max(spread, std::abs(first[i] - first[10]));
    off = std::max(off, std::abs(first[i] - second[i]));
  }
  CHECK(spread > 2e-6);
  CHECK(off < 0.3 * spread + 1e-6);
}

TEST_CASE(
    "By method spm the samples push at the hand's own pose, no stiffer than the object says") {
  ToolScene scene(Method::spm, 800);
  scene.begin();
  scene.settle({0, 0, rest + 0.0003}, Eigen::Quaterniond::Identity(), 3);
  const ContactForce contact =
      scene.settle({0, 0, rest - 0.0005}, Eigen::Quaterniond::Identity(), 3);
  CHECK(contact.contact);
  CHECK(contact.force.z() > 0.2);
  CHECK(contact.force.z() < 800 * 0.0005 * 1.05);
  CHECK(contact.torque.norm() < 1e-4);
  CHECK(contact.depth == Approx(0.0005).epsilon(0.02));
  CHECK((scene.force->tool().pose.translation() - Vector3(0, 0, rest - 0.0005)).norm() < 1e-9);
}

TEST_CASE("A soft object is felt softer than the coupling") {
  ToolScene scene;
  scene.scene.tool->coupling = 1000;
  scene.scene.objects[0].force.stiffness = 250;
  scene.begin();
  scene.settle({0, 0, rest + 0.0003}, Eigen::Quaterniond::Identity(), 20);
  CHECK(scene.settle({0, 0, rest - 0.002}).force.z() == Approx(0.5).epsilon(0.03));
}

TEST_CASE("An object that an application moves takes the tool along, and pushes the hand") {
  ToolScene scene;
  scene.scene.objects[0].movable = true;
  scene.begin();
  scene.settle({0, 0, rest + 0.0003}, Eigen::Quaterniond::Identity(), 20);
  scene.settle({0, 0, rest - 0.0005});
  ContactForce contact;
  // A metre a second upwards into the hand, for two milliseconds.
  for (int tick = 1; tick <= 2; ++tick) {
    scene.force->place(0, {0, 0, -ToolScene::table_size / 2 + 1e-3 * tick},
                       Eigen::Quaterniond::Identity());
    contact = scene.next({0, 0, rest - 0.0005});
  }
  contact = scene.settle({0, 0, rest - 0.0005}, Eigen::Quaterniond::Identity(), 20);
  CHECK(contact.force.z() == Approx(2.5).epsilon(0.04));
  CHECK(scene.force->reaction(0).force.z() == Approx(-2.5).epsilon(0.04));
}

TEST_CASE(
    "However a tool is overrun, objects and applications are told no more than the hand feels") {
  for (const Method method : {Method::proxy, Method::spm}) {
    ToolScene scene(method);
    scene.scene.objects[0].movable = true;
    scene.begin();
    scene.settle({0, 0, rest + 0.0003}, Eigen::Quaterniond::Identity(), 20);
    scene.settle({0, 0, rest - 0.0005});
    const double cap = scene.turning.force_cap;
    for (int tick = 1; tick <= 40; ++tick) {
      // The table comes up by a millimetre a tick, tilted, and there is no time to move on.
      ForceBudget budget;
      budget.refined = budget.worked = 1;
      const double up = 1e-3 * (tick % 8);
      scene.force->place(0, {0, 0, -ToolScene::table_size / 2 + up},
                         turned(0.02 * (tick % 5), {1, 2, 0}));
      const ContactForce contact =
          scene.force->next(scene.assets, HandPose{{0, 0, rest - 0.0005}}, 1, budget);
      REQUIRE(contact.force.norm() <= cap * (1 + 1e-9));
      REQUIRE(scene.force->reaction(0).force.norm() <= cap * (1 + 1e-9));
      Vector3 told = Vector3::Zero();
      for (const ContactPatch& patch : scene.force->tool().contacts()) told += patch.force;
      REQUIRE(told.norm() <= cap * (1 + 1e-9));
    }
  }
}

TEST_CASE("Objects are added, changed and removed under a tool") {
  ToolScene scene;
  scene.begin(1);
  scene.settle({0, 0, rest + 0.0003}, Eigen::Quaterniond::Identity(), 20);
  scene.settle({0, 0, rest - 0.001});
  // A wall beside it.
  PlacedObject wall = ToolScene::object_of(Method::proxy, 1000);
  wall.placement.position = {rest + ToolScene::table_size / 2 + 0.0005, 0, 0};
  const auto number = scene.force->add(wall);
  REQUIRE(number.has_value());
  const ContactForce both = scene.settle({0.002, 0, rest - 0.001});
  CHECK(both.force.x() == Approx(-1.5).epsilon(0.05));
  CHECK(both.force.z() == Approx(1).epsilon(0.05));
  CHECK(scene.force->tool().patch_count >= 2);
  CHECK(scene.force->reaction(*number).force.x() == Approx(1.5).epsilon(0.05));
  scene.force->remove(*number);
  const ContactForce one = scene.settle({0.002, 0, rest - 0.001});
  CHECK(one.force.head<2>().norm() < 0.02);
  scene.force->exchange();
  CHECK(scene.settle({0.002, 0, rest - 0.001}).force.z() == Approx(1).epsilon(0.05));
}

TEST_CASE("An object that takes the number of one that a tool touched begins anew") {
  ToolScene scene;
  scene.scene.objects[0].effects.friction = {0.6, 0.5, 1000};
  scene.begin();
  scene.settle({0, 0, rest + 0.0003}, Eigen::Quaterniond::Identity(), 20);
  scene.settle({0, 0, rest - 0.001});
  // Held by friction against a pull of 0.3 N.
  const Vector3 aside(0.0003, 0, rest - 0.001);
  CHECK(scene.settle(aside).force.x() == Approx(-0.3).epsilon(0.1));
  const PlacedObject same = scene.scene.objects[0];
  scene.force->remove(0);
  REQUIRE(scene.force->add(same) == 0);
  const ContactForce anew = scene.settle(aside);
  CHECK(anew.force.z() == Approx(1).epsilon(0.05));
  CHECK(std::abs(anew.force.x()) < 0.05);
}

TEST_CASE("Contact patches are told by place, normal, depth, force and object, strongest first") {
  ToolScene scene;
  scene.begin();
  scene.settle({0, 0, rest + 0.0003}, turned(0.3, Vector3::UnitY()), 20);
  scene.settle({0, 0, rest - 0.001}, turned(0.3, Vector3::UnitY()));
  const ToolTick& tick = scene.force->tool();
  REQUIRE(tick.patch_count >= 1);
  const ContactPatch& patch = tick.contacts().front();
  CHECK(patch.object == 0);
  CHECK(patch.normal.z() == Approx(1).epsilon(1e-3));
  CHECK(std::abs(patch.place.z()) < 1e-4);
  CHECK(patch.force.z() > 0);
  CHECK(patch.depth > 0);
  for (std::size_t i = 1; i < tick.patch_count; ++i) {
    CHECK(tick.patches[i].force.norm() <= tick.patches[i - 1].force.norm() * (1 + 1e-9));
  }
}

TEST_CASE(
    "Objects out of reach are culled by their boxes and support planes, and no contact is lost") {
  ToolScene scene;
  for (int i = 0; i < 5; ++i) {
    PlacedObject far = ToolScene::object_of(Method::proxy, 1000);
    far.placement.position = {0.2 * (i + 1), 0, 0};
    scene.scene.objects.push_back(far);
  }
  scene.begin();
  scene.settle({0, 0, rest + 0.0003}, Eigen::Quaterniond::Identity(), 20);
  CHECK(scene.settle({0, 0, rest - 0.001}).force.z() == Approx(1).epsilon(0.05));
  CHECK(scene.force->effort().culled == 5);
  // 20 mm over the table, so within the box of its ball, a plane of the table separates them.
  // The octree of one cube tells no clearance, so the way there takes a while.
  scene.settle({0, 0, rest + 0.02}, Eigen::Quaterniond::Identity(), 60);
  CHECK(scene.force->effort().culled == 6);
}

constexpr std::int64_t a_reading = 400;  // ns
std::int64_t fake_now = 0;
std::int64_t interrupted_at = std::numeric_limits<std::int64_t>::max();
std::int64_t fake_clock() noexcept {
  fake_now += a_reading;
  if (fake_now >= interrupted_at) {
    interrupted_at = std::numeric_limits<std::int64_t>::max();
    fake_now += 20'000'000;
  }
  return fake_now;
}

TEST_CASE("A tick that runs out of time is coarser, says so, and is replayed without a clock") {
  for (const Method method : {Method::proxy, Method::spm}) {
    ToolScene live(method), again(method);
    for (ToolScene* scene : {&live, &again}) {
      scene->scene.tool->spacing = 0.0002;
      scene->begin();
    }
    std::size_t degraded = 0, coarse = 0, exact = 0;
    // `spm` needs less of it to get to the finest level.
    const int part = method == Method::spm ? 2 : 1;
    for (int tick = 0; tick < 400; ++tick) {
      const Vector3 at(1e-5 * tick, 0, rest + 0.0005 - std::min(0.001, 1e-5 * tick));
      const Eigen::Quaterniond turn = turned(0.0003 * tick, {1, 0.5, 0.2});
      ForceBudget budget;
      budget.clock = &fake_clock;
      // Now and then there is time enough.
      budget.until_ns = fake_now + (tick % 20 == 19 ? 100'000'000 : (30'000 + 500 * tick) / part);
      // What is known of an object is of use until it is exchanged.
      if (tick % 20 == 0) {
        live.force->exchange();
        again.force->exchange();
      }
      const ContactForce found = live.force->next(live.assets, HandPose{at, turn}, 1, budget);
      const ForceEffort effort = live.force->effort();
      degraded += effort.degraded() ? 1 : 0;
      coarse += effort.level > 0 ? 1 : 0;
      exact += effort.degraded() ? 0 : 1;
      const ContactForce replayed =
          again.force->next(again.assets, HandPose{at, turn}, 1, ForceBudget::again(effort));
      REQUIRE(found.force == replayed.force);
      REQUIRE(found.torque == replayed.torque);
      REQUIRE(effort.level == again.force->effort().level);
      REQUIRE(effort.refined == again.force->effort().refined);
      REQUIRE(effort.worked == again.force->effort().worked);
    }
    CHECK(degraded > 10);
    CHECK(coarse > 5);
    CHECK(exact > 20);
  }
}

/// A tool that slides to and fro, so that each tick has to look anew, within times of a clock that
/// may be interrupted.
class Interrupted {
 public:
  Interrupted() {
    scene_.scene.tool->spacing = 0.0003;
    scene_.begin();
    scene_.settle({0, 0, rest + 0.0003}, Eigen::Quaterniond::Identity(), 20);
    for (int tick = 0; tick < 50; ++tick) {
      const std::int64_t begun = fake_now;
      REQUIRE(!next(1'000'000'000).degraded());
      used_ = std::max(used_, fake_now - begun);
    }
  }
  /// ns: what a tick needs at most.
  [[nodiscard]] std::int64_t used() const noexcept { return used_; }
  [[nodiscard]] std::int64_t readings() const noexcept { return used_ / a_reading; }

  ForceEffort next(std::int64_t time) {
    ForceBudget budget;
    budget.clock = &fake_clock;
    budget.until_ns = fake_now + time;
    const Vector3 at((++ticks_ % 2) * 0.0006, 0, rest - 0.001);
    static_cast<void>(
        scene_.force->next(scene_.assets, HandPose{at, turned(0.02, {1, 0, 0})}, 1, budget));
    return scene_.force->effort();
  }
  /// The core is taken away for 20 ms at a reading of the clock.
  ForceEffort interrupted(std::int64_t time, std::int64_t reading) {
    interrupted_at = fake_now + a_reading * reading;
    const ForceEffort effort = next(time);
    interrupted_at = std::numeric_limits<std::int64_t>::max();
    return effort;
  }

 private:
  ToolScene scene_{Method::spm};
  std::int64_t used_ = 0;
  int ticks_ = 0;
};

TEST_CASE("A tool comes back to its finest level after ticks that were interrupted anywhere") {
  Interrupted tool;
  for (std::int64_t reading = 1; reading < tool.readings(); ++reading) {
    // In a tick that was short of time; the next begins late.
    static_cast<void>(tool.interrupted(tool.used() / 2, reading));
    static_cast<void>(tool.next(0));
    int coarse = 0;
    while (tool.next(4 * tool.used()).degraded()) {
      INFO("interrupted at reading " << reading);
      REQUIRE(++coarse < 40);
    }
  }
}

TEST_CASE("One tick that was interrupted leaves the next ones as fine as before") {
  Interrupted tool;
  int degraded = 0;
  for (std::int64_t reading = 1; reading < tool.readings(); ++reading) {
    INFO("interrupted at reading " << reading);
    degraded += tool.interrupted(4 * tool.used(), reading).degraded() ? 1 : 0;
    for (int tick = 0; tick < 20; ++tick) CHECK_FALSE(tool.next(4 * tool.used()).degraded());
  }
  CHECK(degraded > 5);
}

TEST_CASE("A tick that begins too late for any look leaves the next ones as fine as before") {
  ToolScene scene(Method::spm);
  scene.scene.tool->spacing = 0.0002;
  scene.begin();
  const HandPose pressed{{0, 0, rest - 0.001}, Eigen::Quaterniond::Identity()};
  scene.settle({0, 0, rest + 0.0003}, Eigen::Quaterniond::Identity(), 20);
  const double force = scene.settle(pressed.position, pressed.orientation).force.z();
  REQUIRE(force > 0.1);
  ForceBudget late;
  late.clock = &fake_clock;
  late.until_ns = fake_now;
  for (int k = 0; k < 5; ++k) {
    static_cast<void>(scene.force->next(scene.assets, pressed, 1, late));
    CHECK(scene.force->effort().degraded());
    ForceBudget enough = late;
    enough.until_ns = fake_now + 100'000'000;
    CHECK(scene.force->next(scene.assets, pressed, 1, enough).force.z() == Approx(force));
    CHECK(scene.force->effort().level == 0);
    late.until_ns = fake_now;
  }
}

}  // namespace
}  // namespace spm::tool_scene_test
