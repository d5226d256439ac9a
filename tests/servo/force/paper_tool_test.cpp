// SPDX-License-Identifier: Apache-2.0
#include "servo/force/paper_tool.hpp"

#include <algorithm>
#include <array>
#include <catch2/catch.hpp>
#include <cmath>
#include <cstdint>
#include <memory>
#include <stdexcept>
#include <utility>
#include <vector>

#include "common/base/random.hpp"
#include "servo/force/scene_force.hpp"
#include "servo/stabilize/matched_damping.hpp"
#include "servo/stabilize/turning_lever.hpp"
#include "tests/servo/force/tool_scene.hpp"
#include "tests/support/asset_by_hand.hpp"

namespace spm::paper_tool_test {
namespace {

using test::BoxByHand;

constexpr double margin = 0.0005;
/// m, where the tool touches the table, and where that may still be looked at: box and margin.
constexpr double rest = 0.025;

/// A tool of 20 mm on a table of 30 mm, both `full`; and such tables elsewhere.
struct PaperScene {
  BoxByHand table{Vector3(0.03, 0.03, 0.03), {0.002, margin}}, tool{Vector3(0.02, 0.02, 0.02)};
  std::array<const AssetView*, 2> assets{&table.view, &tool.view};
  std::unique_ptr<SampledTool> sampled;
  std::unique_ptr<SceneForce> force;

  explicit PaperScene(double density) : PaperScene({}, 0, 0, 0, density) {}
  explicit PaperScene(const std::vector<Vector3>& others = {}, double budget = 0,
                      double damping = 0, double damping_share = 0, double density = 1) {
    ForceScene scene;
    scene.stabilization.damping_share = damping_share;
    scene.objects = {test::ToolScene::object_of(Method::paper, 2000)};
    scene.objects[0].effects.damping = damping;
    scene.objects[0].force.density = density;
    scene.added = scene.objects[0];
    for (const Vector3& place : others) {
      scene.objects.push_back(scene.added);
      scene.objects.back().placement.position = place;
    }
    scene.tool = ToolSettings{};
    scene.tool->asset = 1;
    scene.tool->budget = budget;
    auto made = SampledTool::make(tool.view, *scene.tool, 1, scene.objects.size());
    if (!made) throw std::runtime_error(made.error().message);
    sampled = std::move(*made);
    HandTurning turning;
    turning.torque_cap = turning.force_cap = 100;
    force = std::make_unique<SceneForce>(scene, 1e-3, 0, 0, FeltLimits{}, turning);
    force->take_tool(sampled.get(), 0);
  }
  ContactForce next(const Vector3& position, const ForceBudget& budget = {}) {
    return force->next(assets, HandPose{position}, 1, budget);
  }
};

constexpr std::int64_t a_reading = 5000;  // ns
std::int64_t fake_now = 0;
std::int64_t fake_clock() noexcept { return fake_now += a_reading; }

ForceBudget time_of(std::int64_t nanoseconds) {
  ForceBudget budget;
  budget.clock = &fake_clock;
  budget.until_ns = fake_now + nanoseconds;
  return budget;
}
constexpr std::int64_t plenty = 1'000'000'000;

TEST_CASE("By method paper a tool feels one force at the centre of the volume that is shared") {
  PaperScene scene;
  CHECK_FALSE(scene.next({0.002, 0, 0.0255}).contact);
  constexpr double depth = 0.0005;
  const ContactForce contact = scene.next({0.002, 0.001, 0.025 - depth});
  REQUIRE(contact.contact);
  // Its whole face is pressed, and the object is felt as stiff as it is, not stiffer.
  const double wanted = 2000 * depth;
  CHECK(contact.force.z() == Approx(wanted).epsilon(1e-6));
  CHECK(contact.force.head<2>().norm() < 1e-9);
  // The tool is held at its middle, under which the volume lies.
  CHECK(contact.torque.norm() < 0.02 * wanted * 0.01);
  CHECK((scene.force->reaction(0).force + contact.force).norm() < 1e-9);
  REQUIRE(scene.force->tool().patch_count == 1);
  CHECK(scene.force->tool().patches[0].normal.z() == Approx(1));
  CHECK(scene.force->tool().patches[0].depth == Approx(depth).epsilon(1e-6));
}

TEST_CASE("By method paper a part of the tool's face gives a part of the object's stiffness") {
  PaperScene scene;
  constexpr double depth = 0.0005;
  // 4 mm of the tool lie on the table, whose edge is at 15 mm.
  const ContactForce contact = scene.next({0.021, 0, 0.025 - depth});
  REQUIRE(contact.contact);
  const double part = 0.004 * 0.02 / paper_tool_area(scene.tool.view);
  CHECK(part < 1);
  CHECK(contact.force.norm() == Approx(2000 * depth * part).epsilon(0.1));
  CHECK(scene.force->tool().patches[0].depth == Approx(depth).epsilon(1e-6));
}

TEST_CASE("By method paper the force goes by the mass of eq. 12, which the density weighs") {
  PaperScene plain, dense(2.5);
  const Vector3 pressed(0.002, 0.001, 0.0245);
  const ContactForce one = plain.next(pressed), other = dense.next(pressed);
  REQUIRE(one.contact);
  CHECK(other.force.z() == Approx(2.5 * one.force.z()));
  CHECK((other.torque - 2.5 * one.torque).norm() < 1e-9);
  CHECK_FALSE(PaperScene(0.0).next(pressed).contact);
}

TEST_CASE("The sides of a tool's box count, not the margin about them") {
  const BoxByHand tool(Vector3(0.02, 0.02, 0.02), {0.002, 0.004});
  CHECK(paper_tool_area(tool.view) == Approx(6.0 / 16 * 0.02 * 0.02));
}

TEST_CASE("Objects of method paper that a support plane parts from the tool are culled") {
  PaperScene scene({{5, 0, 0}, {5, 0.1, 0.2}, {0, -0.06, -0.01}});
  CHECK(scene.next({0, 0, rest - 0.0005}).contact);
  CHECK(scene.force->effort().culled == 3);
  CHECK_FALSE(scene.force->effort().degraded());
  CHECK_FALSE(scene.next({0, 0, rest + 2 * margin}).contact);
  CHECK(scene.force->effort().culled == 4);
  CHECK_FALSE(scene.next({0, 0, 5}).contact);
  CHECK(scene.force->effort().culled == 4);
}

TEST_CASE("Culling takes no volume from any pose") {
  const BoxByHand object(Vector3(0.03, 0.01, 0.02)), tool(Vector3(0.02, 0.02, 0.01));
  Random random(7);
  std::size_t apart = 0, sharing = 0;
  for (int i = 0; i < 20000; ++i) {
    Eigen::Isometry3d pose = Eigen::Isometry3d::Identity();
    pose.linear() = Eigen::AngleAxisd(random.between(0, 3), random.direction()).toRotationMatrix();
    pose.translation() = random.between(0, 0.04) * random.direction();
    PaperPlanes planes = paper_planes(object.view, tool.view, pose);
    apart += planes.apart ? 1 : 0;
    const bool culled = planes.apart;
    planes.apart = false;
    const bool shares = paper_overlap(object.view, tool.view, pose, planes).volume > 0;
    sharing += shares ? 1 : 0;
    REQUIRE_FALSE((culled && shares));
  }
  CHECK(apart > 2000);
  CHECK(sharing > 2000);
}

TEST_CASE("An object's damping brakes a tool of method paper where it touches, and only there") {
  constexpr double damping = 2, speed = 0.02;
  PaperScene scene({}, 0, damping);
  ContactForce contact;
  for (int tick = 0; tick < 100; ++tick) {
    contact = scene.next({speed * 1e-3 * tick, 0, rest - 0.0005});
  }
  CHECK(contact.force.x() == Approx(-damping * speed).epsilon(0.1));
  CHECK(contact.force.z() == Approx(2000 * 0.0005).epsilon(0.01));
  for (int tick = 0; tick < 100; ++tick) {
    contact = scene.next({-speed * 1e-3 * tick, 0, rest + 0.0003});
  }
  CHECK(contact.force.norm() == 0);
}

TEST_CASE("Matched damping brakes a turn by method paper as its lever and stiffness ask for") {
  PaperScene bare, damped({}, 0, 0, 1);
  constexpr double depth = 0.0005, speed = 0.1;  // m, rad/s
  ContactForce without, with;
  for (int tick = 0; tick < 60; ++tick) {
    // 4 mm of the tool lie on the table; it turns about the edge's direction, by 6 mrad.
    HandPose hand{{0.021, 0, rest - depth}};
    hand.orientation =
        Eigen::Quaterniond(Eigen::AngleAxisd(speed * 1e-3 * (tick - 59), Vector3::UnitY()));
    without = bare.force->next(bare.assets, hand);
    with = damped.force->next(damped.assets, hand);
  }
  REQUIRE(without.contact);
  const ContactPatch& patch = bare.force->tool().patches[0];
  const double arm = (patch.place - Vector3(0.021, 0, rest - depth)).squaredNorm();
  const double stiffness = patch.force.norm() / patch.depth;
  // K (1/2 + d) T for a turn, with the delay of the default settings.
  const StabilizationSettings settings;
  const double all = stiffness * arm * (0.5 + settings.total_delay(1e-3)) * 1e-3 * speed;
  const double fade = std::min(1.0, without.torque.norm() / turning_lever / full_braking_reaction);
  const Vector3 added = with.torque - without.torque;
  CHECK(added.norm() == Approx(all * fade).epsilon(0.05));
  CHECK(added.y() < 0);
}

TEST_CASE("Where a tool of method paper has too little time it takes fewer samples, and says so") {
  PaperScene scene;
  constexpr double depth = 0.0005;
  const Vector3 at(0.002, 0.001, rest - depth);
  const ContactForce exact = scene.next(at, time_of(plenty));
  CHECK_FALSE(scene.force->effort().degraded());
  const ContactForce coarse = scene.next(at, time_of(0));
  CHECK(scene.force->effort().degraded());
  CHECK(scene.force->effort().level == 1);
  // Area and depth stay right.
  CHECK((coarse.force - exact.force).norm() < 1e-9);
  CHECK((coarse.torque - exact.torque).norm() < 1e-9);
  CHECK(scene.next(at, time_of(plenty)).force == exact.force);
  CHECK_FALSE(scene.force->effort().degraded());
}

TEST_CASE("The budget of a scene's tool holds for method paper") {
  PaperScene scene({}, 1e-9);
  static_cast<void>(scene.next({0, 0, rest - 0.0005}, time_of(plenty)));
  CHECK(scene.force->effort().degraded());
  PaperScene enough({}, 1e-3);
  static_cast<void>(enough.next({0, 0, rest - 0.0005}, time_of(plenty)));
  CHECK_FALSE(enough.force->effort().degraded());
}

TEST_CASE("An object that pressed by method paper is the last to be coarser") {
  // The second table is under a corner of the tool, and hardly not touched.
  PaperScene scene({{0.024, 0, -0.0009}});
  const Vector3 at(0.002, 0, rest - 0.0005);
  const ContactForce exact = scene.next(at, time_of(plenty));
  REQUIRE(exact.contact);
  int between = 0;
  for (std::int64_t time = 0; time < 60'000; time += 500) {
    const ContactForce felt = scene.next(at, time_of(time));
    between += scene.force->effort().degraded() ? 1 : 0;
    CHECK((felt.force - exact.force).norm() < 0.2 * exact.force.norm());
  }
  CHECK(between > 5);
  CHECK(between < 115);
}

TEST_CASE("Ticks of method paper that ran out of time are replayed bit by bit without a clock") {
  const std::vector<Vector3> others{{0.031, 0, 0}, {0, 0.031, 0.0002}, {0.031, 0.031, 0}};
  PaperScene live(others), again(others);
  Random random(3);
  std::size_t degraded = 0, exact = 0, touching = 0;
  for (int tick = 0; tick < 2000; ++tick) {
    const double along = 0.016 + 0.01 * std::sin(0.01 * tick);
    const Vector3 at(along, 0.9 * along, rest + 0.0004 * std::cos(0.03 * tick));
    const ForceBudget budget = time_of(static_cast<std::int64_t>(random.between(0, 30'000)));
    const ContactForce found = live.next(at, budget);
    const ForceEffort effort = live.force->effort();
    const ContactForce replayed = again.next(at, ForceBudget::again(effort));
    REQUIRE(found.force == replayed.force);
    REQUIRE(found.torque == replayed.torque);
    REQUIRE(effort.level == again.force->effort().level);
    REQUIRE(effort.worked == again.force->effort().worked);
    REQUIRE(effort.culled == again.force->effort().culled);
    degraded += effort.degraded() ? 1 : 0;
    exact += found.contact && !effort.degraded() ? 1 : 0;
    touching += found.contact ? 1 : 0;
  }
  CHECK(degraded > 200);
  CHECK(exact > 100);
  CHECK(touching > 800);
}

TEST_CASE("The outermost places of a box are its corners") {
  const BoxByHand box(Vector3(0.03, 0.01, 0.02));
  const std::vector<Vector3> places = outermost_places(box.view, 100);
  REQUIRE(places.size() >= 8);
  for (int corner = 0; corner < 8; ++corner) {
    const Vector3 at(corner & 1 ? 0.015 : -0.015, corner & 2 ? 0.005 : -0.005,
                     corner & 4 ? 0.01 : -0.01);
    double nearest = 1;
    for (const Vector3& place : places) nearest = std::min(nearest, (place - at).norm());
    // To a sample of the maps.
    CHECK(nearest < 0.03 / 16 * 1.5);
  }
}

TEST_CASE("A full tool that begins deep in an object is pushed out of it along one way") {
  // In the very middle, where the centres tell no line, and beside it.
  const Vector3 start = GENERATE(Vector3(0, 0, 0), Vector3(0.001, 0.002, 0.0005));
  PaperScene scene;
  Vector3 hand = start;
  ContactForce contact = scene.next(hand);
  const Vector3 way = contact.force.normalized();
  CHECK(contact.force.norm() <= 100 * (1 + 1e-9));
  int ticks = 0;
  for (; contact.force.norm() > 0 && ticks < 1000; ++ticks) {
    CHECK(contact.force.normalized().dot(way) > 0.99);
    hand += 5e-5 * contact.force.normalized();
    contact = scene.next(hand);
  }
  INFO("from " << start.transpose() << " to " << hand.transpose());
  CHECK(ticks < 1000);
  CHECK(hand.cwiseAbs().maxCoeff() > rest - 2 * margin);
}

}  // namespace
}  // namespace spm::paper_tool_test
