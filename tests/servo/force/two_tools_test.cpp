// SPDX-License-Identifier: Apache-2.0
// Two hands whose tools touch each other.
#include <array>
#include <catch2/catch.hpp>
#include <cmath>
#include <memory>
#include <vector>

#include "tests/servo/force/tool_scene.hpp"
#include "tests/support/random.hpp"
#include "tests/support/triangle_octree.hpp"

namespace spm::two_tools_test {
namespace {

using test::RandomTwister;
using test::SparseCubeByHand;
using test::ToolScene;

constexpr double rest = ToolScene::tool_size / 2;

Eigen::Quaterniond turned(double angle, const Vector3& axis) {
  return Eigen::Quaterniond(Eigen::AngleAxisd(angle, axis.normalized()));
}

/// Two hands, each with a small cube, above a table whose top is at z = 0.
struct TwoTools {
  TwoTools() {
    one.scene.tool->coupling = 1000;
    one.scene.more_tools = {*one.scene.tool};
  }
  /// Makes samples and forces of the settings as they are now.
  void begin() {
    const ForceScene& scene = one.scene;
    for (std::size_t hand = 0; hand < 2; ++hand) {
      const ToolSettings& tool = *tool_of(scene, hand);
      auto made = SampledTool::make(*one.assets[tool.asset], tool, 1, objects_to_meet(scene, 0));
      REQUIRE(made);
      sampled[hand] = std::move(*made);
      forces[hand] = std::make_unique<SceneForce>(scene, ToolScene::tick, 0.0, 0, FeltLimits{},
                                                  one.turning, hand);
      forces[hand]->take_tool(sampled[hand].get(), 0);
      hands[hand] = forces[hand].get();
    }
    for (SceneForce* force : hands) force->meet(hands);
  }
  /// A tick with the hands at these poses.
  void next(const HandPose& first, const HandPose& second) {
    felt[0] = forces[0]->next(one.assets, first);
    felt[1] = forces[1]->next(one.assets, second);
  }
  void settle(const HandPose& first, const HandPose& second, int ticks = 200) {
    for (int i = 0; i < ticks; ++i) next(first, second);
  }
  [[nodiscard]] const Eigen::Isometry3d& pose(std::size_t hand) const {
    return forces[hand]->tool().pose;
  }

  ToolScene one;
  std::array<std::unique_ptr<SampledTool>, 2> sampled;
  std::array<std::unique_ptr<SceneForce>, 2> forces;
  std::array<SceneForce*, 2> hands{};
  std::array<ContactForce, 2> felt;
};

HandPose at(double x, double y = 0, double z = 0.05) { return {{x, y, z}}; }

TEST_CASE("Two tools that press on each other push both hands alike") {
  for (const double stiffer : {1000.0, 2000.0, 500.0}) {
    TwoTools tools;
    tools.one.scene.more_tools[0].coupling = stiffer;
    tools.begin();
    tools.settle(at(-rest - 0.002), at(rest + 0.002), 5);
    CHECK_FALSE(tools.felt[0].contact);
    CHECK_FALSE(tools.felt[1].contact);
    tools.settle(at(-rest + 0.001), at(rest - 0.001));
    // Two springs, one behind the other, over the 2 mm by which the hands want too much.
    const double wanted = 0.002 / (1 / 1000.0 + 1 / stiffer);
    CHECK(tools.felt[0].contact);
    CHECK(tools.felt[1].contact);
    CHECK(tools.felt[0].force.x() == Approx(-wanted).epsilon(0.05));
    CHECK(tools.felt[1].force.x() == Approx(wanted).epsilon(0.05));
    CHECK((tools.felt[0].force + tools.felt[1].force).norm() < 0.03 * wanted);
    CHECK(tools.felt[0].torque.norm() < 2e-4);
    CHECK(tools.felt[1].torque.norm() < 2e-4);
    // At rest nothing trembles.
    const std::array<ContactForce, 2> before = tools.felt;
    for (int i = 0; i < 20; ++i) {
      tools.next(at(-rest + 0.001), at(rest - 0.001));
      for (std::size_t hand = 0; hand < 2; ++hand) {
        REQUIRE((tools.felt[hand].force - before[hand].force).norm() < 0.01 * wanted);
      }
    }
    // They touch where they are drawn.
    CHECK((tools.pose(1).translation() - tools.pose(0).translation()).x() ==
          Approx(2 * rest).margin(5e-5));
    // And let go of each other.
    tools.settle(at(-rest - 0.002), at(rest + 0.002), 20);
    CHECK(tools.felt[0].force.norm() < 1e-9);
    CHECK(tools.felt[1].force.norm() < 1e-9);
  }
}

TEST_CASE("A tool that presses beside the middle of another turns both") {
  TwoTools tools;
  tools.begin();
  tools.settle(at(-rest - 0.002, 0.004), at(rest + 0.002, -0.004), 5);
  tools.settle(at(-rest + 0.001, 0.004), at(rest - 0.001, -0.004));
  // Each is pushed at the half of its face that the other meets.
  CHECK(std::abs(tools.felt[0].torque.z()) > 5e-4);
  CHECK(tools.felt[0].torque.z() == Approx(tools.felt[1].torque.z()).epsilon(0.15));
  CHECK((tools.felt[0].force + tools.felt[1].force).norm() < 0.05);
}

TEST_CASE("A tool that comes at 1 m/s takes the other along, and is not passed") {
  for (const bool first_comes : {true, false}) {
    TwoTools tools;
    tools.begin();
    const double side = first_comes ? 1 : -1;
    const auto tick = [&](double coming, double resting) {
      if (first_comes) {
        tools.next(at(coming), at(resting));
      } else {
        tools.next(at(-resting), at(-coming));
      }
    };
    for (int i = 0; i < 5; ++i) tick(-0.03, 0);
    for (int i = 0; i < 34; ++i) {
      tick(-0.03 + 1e-3 * i, 0);
      INFO("tick " << i);
      REQUIRE((tools.pose(1).translation() - tools.pose(0).translation()).x() > rest);
      for (const ContactForce& felt : tools.felt) {
        REQUIRE(felt.force.norm() <= tools.one.turning.force_cap * (1 + 1e-9));
      }
    }
    CHECK(side * tools.felt[first_comes ? 1 : 0].force.x() > 2);
  }
}

TEST_CASE("Two tools that begin in one another leave each other slowly, without a kick") {
  TwoTools tools;
  tools.begin();
  std::array<double, 2> last{};
  double most_step = 0;
  for (int i = 0; i < 600; ++i) {
    tools.next(at(-rest + 0.001), at(rest - 0.002));
    for (std::size_t hand = 0; hand < 2; ++hand) {
      const double force = tools.felt[hand].force.norm();
      most_step = std::max(most_step, std::abs(force - last[hand]));
      last[hand] = force;
    }
  }
  // The coupling's force grows by no more than a short step a tick stretches it.
  CHECK(most_step < 0.06);
  CHECK(tools.felt[0].force.x() == Approx(-1.5).epsilon(0.06));
  CHECK(tools.felt[1].force.x() == Approx(1.5).epsilon(0.06));
}

TEST_CASE("Two tools in one another's middle part, one after the other, and press as ever then") {
  // 30 mm, far deeper than the band.
  const bool round = GENERATE(false, true);
  TwoTools tools;
  SparseCubeByHand& tool = tools.one.tool_cube;
  if (round) {
    tool.planes.clear();
    tool.replace_triangles(test::sphere(rest, 2));
  }
  tools.one.scene.tool->placement.scale = 2.5;
  tools.one.scene.tool->spacing = 0.0008;
  tools.one.scene.more_tools = {*tools.one.scene.tool};
  tools.begin();
  const double apart = 5 * rest;
  const HandPose first = at(0, 0, 0.1), second = at(0.0002, -0.0001, 0.1);
  std::array<Vector3, 2> last{Vector3::Zero(), Vector3::Zero()};
  double most_step = 0;
  bool led = false;
  for (int i = 0; i < 2000; ++i) {
    tools.next(first, second);
    for (std::size_t hand = 0; hand < 2; ++hand) {
      const Vector3& force = tools.felt[hand].force;
      REQUIRE(force.norm() <= tools.one.turning.force_cap * (1 + 1e-9));
      most_step = std::max(most_step, (force - last[hand]).norm());
      last[hand] = force;
    }
    led = led || tools.forces[0]->tool().leaving;
  }
  CHECK(led);
  // Balls that hands press on each other with all force slide about each other.
  CHECK(most_step < (round ? 0.3 : 0.12));
  CHECK_FALSE(tools.forces[0]->tool().leaving);
  CHECK_FALSE(tools.forces[1]->tool().leaving);
  const Vector3 between = tools.pose(1).translation() - tools.pose(0).translation();
  const double found = round ? between.norm() : between.cwiseAbs().maxCoeff();
  CHECK(found == Approx(apart).epsilon(round ? 0.05 : 0.007));
  // Both hands feel the cap, and each the other.
  CHECK((tools.felt[0].force + tools.felt[1].force).norm() < 0.5);
  CHECK(tools.felt[0].force.norm() > 0.9 * tools.one.turning.force_cap);
}

TEST_CASE("A tool whose hand gets no force is not there for others, and comes back slowly") {
  TwoTools tools;
  tools.begin();
  tools.settle(at(-rest - 0.002), at(rest + 0.002), 5);
  tools.settle(at(-rest + 0.001), at(rest - 0.001));
  for (const std::size_t gone : {1U, 0U}) {
    for (int i = 0; i < 20; ++i) {
      tools.forces[gone]->reset();
      const HandPose hand = gone == 0 ? at(rest - 0.001) : at(-rest + 0.001);
      tools.felt[1 - gone] = tools.forces[1 - gone]->next(tools.one.assets, hand);
    }
    CHECK(tools.felt[1 - gone].force.norm() < 1e-9);
    double last = 0, most_step = 0;
    for (int i = 0; i < 400; ++i) {
      tools.next(at(-rest + 0.001), at(rest - 0.001));
      most_step = std::max(most_step, std::abs(tools.felt[1 - gone].force.norm() - last));
      last = tools.felt[1 - gone].force.norm();
    }
    CHECK(most_step < 0.06);
    CHECK(tools.felt[0].force.x() == Approx(-1).epsilon(0.06));
  }
}

TEST_CASE("A hand whose pose is none does nothing to the other one, and begins anew") {
  TwoTools tools;
  tools.begin();
  tools.settle(at(-rest - 0.002), at(rest + 0.002), 5);
  tools.settle(at(-rest + 0.001), at(rest - 0.001));
  HandPose unknown = at(-rest), stretched = at(-rest), mirrored = at(-rest + 0.001);
  unknown.position.y() = std::nan("");
  stretched.orientation.coeffs() *= 1.5;
  mirrored.orientation.coeffs() *= -1;  // the same turn
  for (const HandPose& bad : {unknown, stretched}) {
    for (int i = 0; i < 3; ++i) {
      tools.next(bad, at(rest - 0.001));
      CHECK_FALSE(tools.felt[0].contact);
      CHECK(tools.felt[0].force == Vector3::Zero());
      CHECK(tools.felt[1].force.norm() < 1e-9);
    }
    tools.settle(mirrored, at(rest - 0.001), 400);
    CHECK(tools.felt[0].force.x() == Approx(-1).epsilon(0.06));
    CHECK(tools.felt[1].force.x() == Approx(1).epsilon(0.06));
  }
}

TEST_CASE("A hand that turns its tool by half a turn in a tick within another meets its caps") {
  TwoTools tools;
  tools.begin();
  tools.settle(at(-rest - 0.002), at(rest + 0.002), 5);
  tools.settle(at(-rest + 0.001), at(rest - 0.001));
  HandPose half_turned = at(-rest + 0.001);
  for (int i = 0; i < 100; ++i) {
    half_turned.orientation =
        turned(i % 2 == 0 ? 3.14159265358979 : 0, i % 3 == 0 ? Vector3(0, 1, 1) : Vector3(1, 2, 3));
    tools.next(half_turned, at(rest - 0.001));
    for (const ContactForce& felt : tools.felt) {
      REQUIRE(felt.force.allFinite());
      REQUIRE(felt.torque.allFinite());
      REQUIRE(felt.force.norm() <= tools.one.turning.force_cap * (1 + 1e-9));
      REQUIRE(felt.torque.norm() <= tools.one.turning.torque_cap * (1 + 1e-9));
    }
  }
}

TEST_CASE("Tools of a thousandth and of a thousand times their size push each other finitely") {
  for (const double scale : {1e-6, 1e-3, 1e3, 1e6}) {
    TwoTools tools;
    tools.one.scene.tool->placement.scale = scale;
    tools.one.scene.tool->spacing = 0.0012;
    tools.one.scene.more_tools[0].placement.scale = scale;
    tools.one.scene.more_tools[0].spacing = 0.0012;
    tools.begin();
    const double reach = scale * rest;
    for (int i = 0; i < 60; ++i) {
      const double way = reach * (1.2 - 0.01 * i);
      tools.next(at(-way, 0, 0.05 + 3 * reach), at(way, 0, 0.05 + 3 * reach));
      for (const ContactForce& felt : tools.felt) {
        REQUIRE(felt.force.allFinite());
        REQUIRE(felt.torque.allFinite());
        REQUIRE(felt.force.norm() <= tools.one.turning.force_cap * (1 + 1e-9));
      }
    }
  }
}

TEST_CASE("A tool that is pressed between another one and a table stays on the table") {
  for (const bool first_lies : {true, false}) {
    TwoTools tools;
    tools.begin();
    const auto tick = [&](double lying, double pressing) {
      const HandPose low = at(0, 0, lying), high = at(0.001, 0.001, pressing);
      first_lies ? tools.next(low, high) : tools.next(high, low);
    };
    for (int i = 0; i < 50; ++i) tick(rest + 0.0002, 3 * rest + 0.002);
    for (int i = 0; i < 400; ++i) tick(rest + 0.0002, 3 * rest - std::min(0.003, 1e-5 * i));
    const std::size_t low = first_lies ? 0 : 1, high = 1 - low;
    CHECK(tools.pose(low).translation().z() == Approx(rest).margin(1e-4));
    CHECK(tools.pose(high).translation().z() == Approx(3 * rest).margin(1.5e-4));
    CHECK(tools.felt[high].force.z() == Approx(3).epsilon(0.08));
    // The table carries what the upper hand presses with.
    CHECK(tools.forces[low]->reaction(0).force.z() == Approx(-3).epsilon(0.15));
  }
}

TEST_CASE("Both tools tell where they touch each other, by the other device's number") {
  TwoTools tools;
  tools.begin();
  tools.settle(at(-rest - 0.002), at(rest + 0.002), 5);
  tools.settle(at(-rest + 0.001), at(rest - 0.001));
  for (std::size_t hand = 0; hand < 2; ++hand) {
    const auto patches = tools.forces[hand]->tool().contacts();
    REQUIRE_FALSE(patches.empty());
    const double out = hand == 0 ? -1 : 1;
    Vector3 sum = Vector3::Zero();
    for (const ContactPatch& patch : patches) {
      CHECK(patch.object == (tool_of_device | (1 - hand)));
      CHECK(out * patch.normal.x() > 0.9);
      CHECK(std::abs(patch.place.x()) < 5e-4);
      sum += patch.force;
    }
    CHECK(sum.x() == Approx(out).epsilon(0.08));
  }
}

TEST_CASE("Hands that wave their tools at each other get finite forces within their caps") {
  TwoTools tools;
  tools.one.scene.objects[0].effects.friction = {0.5, 0.4, 1000};
  tools.one.scene.objects[0].effects.damping = 2;
  tools.one.scene.added.effects = tools.one.scene.objects[0].effects;
  tools.begin();
  RandomTwister random(11);
  for (int i = 0; i < 3000; ++i) {
    const double t = 1e-3 * i;
    const HandPose first{{0.006 * std::sin(9 * t), 0.003 * std::sin(7 * t), rest + 0.002},
                         turned(std::sin(5 * t), {1, 2, 3})};
    const HandPose second{
        {0.012 + 0.006 * std::sin(11 * t), 0.002, rest + 0.001 * std::sin(13 * t)},
        turned(0.7 * std::sin(6 * t), random.vector(1))};
    tools.next(first, second);
    for (const ContactForce& felt : tools.felt) {
      REQUIRE(felt.force.allFinite());
      REQUIRE(felt.torque.allFinite());
      REQUIRE(felt.force.norm() <= tools.one.turning.force_cap * (1 + 1e-9));
      REQUIRE(felt.torque.norm() <= tools.one.turning.torque_cap * (1 + 1e-9));
    }
  }
}

TEST_CASE("Two hands of mass that hold tools against each other come to rest") {
  TwoTools tools;
  tools.one.scene.stabilization = recommended_stabilization;
  tools.begin();
  // Each hand: 0.2 kg on a spring of 300 N/m with a damper, to a place within the other's tool.
  struct Mass {
    double x, wanted, velocity = 0;
    void step(double force) {
      velocity += 1e-3 / 0.2 * (force + 300 * (wanted - x) - 5 * velocity);
      x += 1e-3 * velocity;
    }
  };
  Mass first{-rest - 0.004, -rest + 0.005}, second{rest + 0.004, rest - 0.005};
  double late_speed = 0;
  for (int i = 0; i < 2000; ++i) {
    tools.next(at(first.x), at(second.x));
    for (std::size_t hand = 0; hand < 2; ++hand) {
      tools.forces[hand]->sent(Wrench{tools.felt[hand].force, tools.felt[hand].torque});
    }
    first.step(tools.felt[0].force.x());
    second.step(tools.felt[1].force.x());
    if (i >= 1700) {
      late_speed = std::max({late_speed, std::abs(first.velocity), std::abs(second.velocity)});
    }
  }
  CHECK(late_speed < 2e-4);
  CHECK(tools.felt[0].force.x() < -0.8);
  CHECK(tools.felt[1].force.x() == Approx(-tools.felt[0].force.x()).epsilon(0.05));
}

/// Two hands with tools of the paper's method.
struct PaperTools {
  test::BoxByHand table{Vector3(0.03, 0.03, 0.03)}, tool{Vector3(0.02, 0.02, 0.02)};
  std::array<const AssetView*, 2> assets{&table.view, &tool.view};
  std::array<std::unique_ptr<SampledTool>, 2> sampled;
  std::array<std::unique_ptr<SceneForce>, 2> forces;
  std::array<SceneForce*, 2> hands{};

  PaperTools() {
    ForceScene scene;
    scene.objects = {ToolScene::object_of(Method::paper, 2000)};
    scene.added = scene.objects[0];
    scene.tool = ToolSettings{};
    scene.tool->asset = 1;
    scene.more_tools = {*scene.tool};
    HandTurning turning;
    turning.torque_cap = turning.force_cap = 100;
    for (std::size_t hand = 0; hand < 2; ++hand) {
      auto made = SampledTool::make(tool.view, *scene.tool, 1, objects_to_meet(scene, 0));
      REQUIRE(made);
      sampled[hand] = std::move(*made);
      forces[hand] = std::make_unique<SceneForce>(scene, 1e-3, 0, 0, FeltLimits{}, turning, hand);
      forces[hand]->take_tool(sampled[hand].get(), 0);
      hands[hand] = forces[hand].get();
    }
    for (SceneForce* force : hands) force->meet(hands);
  }
};

TEST_CASE("Full tools push each other by the paper's equations, both hands alike") {
  PaperTools tools;
  std::array<ContactForce, 2> felt;
  constexpr double depth = 0.0005;
  for (int i = 0; i < 5; ++i) {
    felt[0] = tools.forces[0]->next(tools.assets, HandPose{{0, 0, 0.1}});
    felt[1] = tools.forces[1]->next(tools.assets, HandPose{{0.001, 0.002, 0.12 - depth}});
  }
  CHECK(felt[0].force.z() == Approx(-2000 * depth).epsilon(1e-3));
  CHECK((felt[0].force + felt[1].force).norm() < 1e-9);
  REQUIRE(tools.forces[1]->tool().patch_count == 1);
  CHECK(tools.forces[1]->tool().patches[0].object == tool_of_device);
  CHECK(tools.forces[1]->tool().patches[0].normal.z() == Approx(1));
}

}  // namespace
}  // namespace spm::two_tools_test
