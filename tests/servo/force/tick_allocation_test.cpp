// SPDX-License-Identifier: Apache-2.0
#include <array>
#include <catch2/catch.hpp>
#include <span>
#include <vector>

#include "common/sixdof/virtual_tool.hpp"
#include "servo/force/scene_force.hpp"
#include "servo/force/tool_culling.hpp"
#include "tests/servo/force/tool_scene.hpp"
#include "tests/servo/support/intercepted_calls.hpp"
#include "tests/support/asset_by_hand.hpp"

namespace spm::tick_allocation_test {
namespace {

using Eigen::Isometry3d;

TEST_CASE("Ticks of contact, virtual tool and culling allocate, lock and write nothing") {
  const test::SparseCubeByHand object(0.04), small(0.012);
  const SurfaceSamples samples = *sample_surface(small.view, 0.0006);
  ObjectContact contact(samples, {});
  VirtualTool tool(contact, {}, 0.012);
  const SupportHull hull = support_hull(samples);
  ToolCulling culling(hull, 1);
  const std::array objects{ContactObject{&object.view, Isometry3d::Identity()}};
  std::uint64_t contacts = 0;
  const test::InterceptedCalls before = test::intercepted_calls();
  test::watch(true);
  tool.place(Isometry3d(Eigen::Translation3d(0, 0, 0.03)));
  for (int tick = 0; tick < 100; ++tick) {
    const Isometry3d pose(Eigen::Translation3d(0, 0, 0.03 - 1e-4 * tick));
    contacts += tool.tick(pose, objects).contact.sum.contacts;
    (void)culling.apart(0, objects[0], pose, 0.001);
    if (tick == 50) contact.forget(0);
  }
  test::watch(false);
  const test::InterceptedCalls after = test::intercepted_calls();
  CHECK(contacts > 0);
  CHECK(after.allocations == before.allocations);
  CHECK(after.locks == before.locks);
  CHECK(after.writes == before.writes);
}

TEST_CASE(
    "A tick of a small tool among hundreds of objects allocates nothing, and feels them all") {
  const test::SparseCubeByHand object(0.04), small(0.012);
  const SurfaceSamples samples = *sample_surface(small.view, 0.006);
  constexpr std::size_t count = 600;
  ObjectContactSettings settings;
  settings.objects = count;
  const std::vector<ContactObject> objects(count,
                                           {&object.view, Isometry3d::Identity(), 1, 1e9 / count});
  const std::span<const ContactObject> one(objects.data(), 1);
  const Isometry3d pose(Eigen::Translation3d(0.001, 0.002, 0.025));
  for (const double accuracy : {0.0, 0.1}) {
    TickBudget budget;
    budget.accuracy = accuracy;
    ObjectContact contact(samples, settings), alone(samples, settings);
    const double wanted = count * alone.tick(pose, one, budget).sum.forces().force.z();
    const test::InterceptedCalls before = test::intercepted_calls();
    test::watch(true);
    const ObjectContactReport report = contact.tick(pose, objects, budget);
    test::watch(false);
    CHECK(test::intercepted_calls().allocations == before.allocations);
    REQUIRE(wanted > 0);
    CHECK(report.sum.forces().force.z() == Approx(wanted).epsilon(0.2));
  }
}

TEST_CASE(
    "A tick of a scene with every effect and stabilizer allocates, locks and writes nothing") {
  const test::SparseCubeByHand cube(0.04);
  PlacedObject object;
  object.effects.friction = {0.5, 0.4, 2000};
  object.effects.damping = 2;
  object.effects.texture = {50e-6, 1e-3, 7};
  object.effects.smoothing = {1e-4, 7};
  ForceScene scene{{}, {object, object, object}};
  scene.objects[1].placement.position = {0.039, 0, 0};
  scene.objects[1].force.method = Method::proxy;
  scene.objects[2].placement.position = {1, 0, 0};
  REQUIRE(parse_stabilization("damping+coupling+passivity+potential", scene.stabilization));
  scene.stabilization.coupling_damping = 1;
  SceneForce force(scene, 1e-3, 2e-5);
  const std::array<const AssetView*, 1> assets{&cube.view};
  std::uint64_t contacts = 0;
  const test::InterceptedCalls before = test::intercepted_calls();
  test::watch(true);
  for (int tick = 0; tick < 400; ++tick) {
    contacts += force.next(assets, {1e-4 * tick, 0.003, 0.019}).contact ? 1 : 0;
    if (tick == 200) force.reset();
    if (tick == 300) force.stabilize(recommended_stabilization);
  }
  test::watch(false);
  const test::InterceptedCalls after = test::intercepted_calls();
  CHECK(contacts > 300);
  CHECK(after.allocations == before.allocations);
  CHECK(after.locks == before.locks);
  CHECK(after.writes == before.writes);
}

TEST_CASE("A tick of a ball or a capsule by the paper allocates, locks and writes nothing") {
  const test::BoxByHand box({0.04, 0.04, 0.04});
  const std::array<const AssetView*, 1> assets{&box.view};
  for (const ProbeShape& probe :
       {ProbeShape{ProbeKind::ball, 2e-3, 0}, ProbeShape{ProbeKind::capsule, 1e-3, 0.01}}) {
    for (const PaperProbeForm form : {PaperProbeForm::surface, PaperProbeForm::volume}) {
      PlacedObject object;
      object.force.method = Method::paper;
      object.force.take_probe(probe);
      object.force.form = form;
      object.effects.friction_force = 0.1;
      SceneForce force({{}, {object}, recommended_stabilization}, 1e-3, 2e-5);
      std::uint64_t contacts = 0;
      const test::InterceptedCalls before = test::intercepted_calls();
      test::watch(true);
      for (int tick = 0; tick < 100; ++tick) {
        contacts += force.next(assets, {1e-4 * tick, 0.003, 0.019}).contact ? 1 : 0;
      }
      test::watch(false);
      const test::InterceptedCalls after = test::intercepted_calls();
      CHECK(contacts == 100);
      CHECK(after.allocations == before.allocations);
      CHECK(after.locks == before.locks);
      CHECK(after.writes == before.writes);
    }
  }
}

TEST_CASE("A tick of a tool with six degrees of freedom allocates, locks and writes nothing") {
  for (const Method method : {Method::proxy, Method::spm}) {
    test::ToolScene scene(method);
    PlacedObject& table = scene.scene.objects[0];
    table.effects.friction = {0.5, 0.4, 2000};
    table.effects.damping = 2;
    table.effects.texture = {50e-6, 1e-3, 7};
    table.movable = true;
    scene.scene.stabilization = recommended_stabilization;
    scene.begin(1);
    std::uint64_t contacts = 0;
    const test::InterceptedCalls before = test::intercepted_calls();
    test::watch(true);
    for (int tick = 0; tick < 300; ++tick) {
      const ContactForce contact = scene.next({1e-5 * tick, 0, 0.0065 - 1e-5 * tick});
      scene.force->sent(Wrench{contact.force, contact.torque});
      contacts += contact.contact ? 1 : 0;
      if (tick == 120) static_cast<void>(scene.force->add(table));
      if (tick == 140) scene.force->remove(1);
      if (tick == 160) scene.force->place(0, {0, 0, -0.0201}, Eigen::Quaterniond::Identity());
      if (tick == 180) scene.force->stabilize(recommended_stabilization);
      if (tick == 200) scene.force->exchange();
      if (tick == 220) scene.force->take_tool(nullptr, 0);
      if (tick == 221) scene.force->take_tool(scene.sampled.get(), 0);
      if (tick == 250) scene.force->reset();
    }
    test::watch(false);
    const test::InterceptedCalls after = test::intercepted_calls();
    CHECK(contacts > 150);
    CHECK(after.allocations == before.allocations);
    CHECK(after.locks == before.locks);
    CHECK(after.writes == before.writes);
  }
}

}  // namespace
}  // namespace spm::tick_allocation_test
