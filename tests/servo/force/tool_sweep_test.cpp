// SPDX-License-Identifier: Apache-2.0
// Objects that move fast past a tool that rests.
#include <array>
#include <catch2/catch.hpp>
#include <cmath>
#include <cstdint>

#include "tests/servo/force/tool_scene.hpp"
#include "tests/support/random.hpp"

namespace spm::tool_sweep_test {
namespace {

using test::RandomTwister;
using test::ToolScene;

constexpr double rest = ToolScene::tool_size / 2;
constexpr double thickness = 0.0002;

Eigen::Quaterniond turned(double angle, const Vector3& axis) {
  return Eigen::Quaterniond(Eigen::AngleAxisd(angle, axis.normalized()));
}

/// A tool in the air, and a plate of 0.2 mm across z of which the wide faces are shown.
struct PlateScene : ToolScene {
  explicit PlateScene(double tool_scale = 1) {
    for (std::size_t k : {4U, 5U}) table.planes[k].x0 *= thickness / table_size;
    table.replace_triangles(test::box({table_size, table_size, thickness}));
    scene.tool->spacing = 0.001;
    scene.tool->placement.scale = tool_scale;
    scene.objects[0].movable = true;
    scene.objects[0].placement.position = {0, 0, -0.02};
    begin();
  }
  /// The plate's middle at a height.
  void plate_at(double z, const Eigen::Quaterniond& turn = Eigen::Quaterniond::Identity()) {
    force->place(0, {0, 0, z}, turn);
  }
  /// How high the tool's middle is over the plate, across it.
  [[nodiscard]] double over(double z, const Eigen::Quaterniond& turn) const {
    return (turn.conjugate() * (force->tool().pose.translation() - Vector3(0, 0, z))).z();
  }
};

TEST_CASE("A plate of 0.2 mm that moves at 1 m/s does not pass a tool that rests") {
  RandomTwister random(3);
  for (int attempt = 0; attempt < 40; ++attempt) {
    // Also a tool as thin as the plate's way in a tick.
    PlateScene scene(attempt % 4 == 0 ? 0.05 : 1);
    const Eigen::Quaterniond hand = turned(3 * random.between(-1, 1), random.vector(1));
    const Eigen::Quaterniond plate = turned(0.3 * random.between(-1, 1), random.vector(1));
    const double begin = -0.0145 + 1e-3 * random.between(0, 1);
    scene.plate_at(begin, plate);
    scene.settle(Vector3::Zero(), hand, 3);
    double height = begin;
    for (int tick = 0; tick < 24; ++tick) {
      height += 1e-3;
      scene.plate_at(height, plate);
      const ContactForce contact = scene.next(Vector3::Zero(), hand);
      REQUIRE(contact.force.norm() <= scene.turning.force_cap * (1 + 1e-9));
      INFO("attempt " << attempt << ", tick " << tick);
      REQUIRE(scene.over(height, plate) > 0);
    }
    // It took the tool along, as far as the coupling lets it.
    CHECK(scene.next(Vector3::Zero(), hand).force.z() > 1);
  }
}

TEST_CASE("A plate that turns fast takes a tool beside its axis along") {
  ToolScene scene;
  scene.scene.objects[0].movable = true;
  scene.scene.objects[0].placement.position = {0, 0, -0.05};
  scene.begin();
  // The table is turned about the tool's far side: its top sweeps by a millimetre a tick.
  const Vector3 hand(0, 0, 0);
  scene.force->place(0, {0, 0, -ToolScene::table_size / 2 - rest - 0.0005},
                     Eigen::Quaterniond::Identity());
  scene.settle(hand, Eigen::Quaterniond::Identity(), 20);
  ContactForce contact;
  for (int tick = 1; tick <= 8; ++tick) {
    const Eigen::Quaterniond turn = turned(0.03 * tick, Vector3::UnitY());
    scene.force->place(0, {0, 0, -ToolScene::table_size / 2 - rest - 0.0005}, turn);
    contact = scene.next(hand);
  }
  CHECK(contact.contact);
  CHECK(contact.force.z() > 0.3);
}

TEST_CASE("An object that jumps by more than a fast hand moves is there at once") {
  PlateScene scene;
  scene.plate_at(-0.02);
  scene.settle(Vector3::Zero(), Eigen::Quaterniond::Identity(), 3);
  scene.plate_at(0.02);
  const ContactForce contact = scene.next(Vector3::Zero());
  CHECK_FALSE(contact.contact);
  CHECK(scene.force->tool().pose.translation().norm() < 1e-9);
}

std::int64_t fake_now = 0;
std::int64_t fake_clock() noexcept { return fake_now += 400; }

/// A tool between two plates of 0.2 mm, of which the wide faces are shown.
struct TwoPlates : PlateScene {
  TwoPlates() {
    scene.objects.push_back(scene.objects[0]);
    begin();
  }
  /// Places a plate `gap` (m) before the hand's origin; its side towards the tool looks along
  /// `normal`.
  void wall(std::size_t number, const Vector3& normal, double gap) {
    normals[number] = normal.normalized();
    gaps[number] = gap + thickness / 2;
    force->place(number, -gaps[number] * normals[number],
                 Eigen::Quaterniond::FromTwoVectors(Vector3::UnitZ(), normal));
  }
  /// How far the tool's middle is from a plate's, on the side where it began, m.
  [[nodiscard]] double beside(std::size_t number) const {
    return gaps[number] + normals[number].dot(force->tool().pose.translation());
  }
  /// A tick in which time runs out where there is little of it.
  void next_within(std::int64_t time) {
    ForceBudget budget;
    budget.clock = &fake_clock;
    budget.until_ns = fake_now + time;
    const HandPose hand{Vector3::Zero(), Eigen::Quaterniond::Identity()};
    static_cast<void>(force->next(assets, hand, 1, budget));
  }

  std::array<Vector3, 2> normals;
  std::array<double, 2> gaps{};
};

TEST_CASE("A tool does not pass a second plate where time runs out while one takes it along") {
  // The second plate stands aslant in the tool's way; or it moves as well, and meets it first
  // later.
  for (const bool both_move : {false, true}) {
    std::size_t stopped = 0;
    for (int attempt = 0; attempt < 10; ++attempt) {
      TwoPlates scene;
      const Vector3 aside(-1, 0, both_move ? 0 : -1);
      const double reach = both_move ? rest + 0.0015 : rest * std::sqrt(2) + 0.0004;
      scene.wall(0, Vector3::UnitZ(), rest + 0.0005);
      scene.wall(1, aside, reach);
      scene.settle(Vector3::Zero(), Eigen::Quaterniond::Identity(), 5);
      for (int tick = 1; tick <= 16; ++tick) {
        scene.wall(0, Vector3::UnitZ(), rest + 0.0005 - 0.0006 * tick);
        if (both_move) scene.wall(1, aside, reach - 0.0007 * tick);
        scene.next_within(tick % 3 == 0 ? 4'000 + 4'500 * attempt : 1'000'000'000);
        stopped += scene.force->effort().stopped() ? 1 : 0;
        INFO("attempt " << attempt << ", tick " << tick << ", both move " << both_move);
        REQUIRE(scene.beside(0) > 0);
        REQUIRE(scene.beside(1) > 0);
      }
    }
    CHECK(stopped > 10);
  }
}

TEST_CASE("A tick whose time ends while objects go their ways is replayed without a clock") {
  PlateScene live, again;
  std::size_t stopped = 0, touched = 0;
  for (int tick = 0; tick < 200; ++tick) {
    const double height = -0.008 + 1e-3 * (tick % 8) + 0.001 * std::sin(0.1 * tick);
    ForceBudget budget;
    budget.clock = &fake_clock;
    budget.until_ns = fake_now + 20'000 + std::int64_t{500} * tick;
    live.plate_at(height);
    again.plate_at(height);
    const Eigen::Quaterniond turn = turned(0.001 * tick, {1, 2, 3});
    const ContactForce found =
        live.force->next(live.assets, HandPose{Vector3::Zero(), turn}, 1, budget);
    const ForceEffort effort = live.force->effort();
    stopped += effort.stopped() ? 1 : 0;
    touched += found.contact ? 1 : 0;
    const ContactForce replayed = again.force->next(again.assets, HandPose{Vector3::Zero(), turn},
                                                    1, ForceBudget::again(effort));
    REQUIRE(found.force == replayed.force);
    REQUIRE(found.torque == replayed.torque);
    REQUIRE(effort.refined == again.force->effort().refined);
    REQUIRE(effort.worked == again.force->effort().worked);
  }
  CHECK(stopped > 10);
  CHECK(touched > 20);
}

}  // namespace
}  // namespace spm::tool_sweep_test
