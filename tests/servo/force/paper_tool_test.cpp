// SPDX-License-Identifier: Apache-2.0
#include "servo/force/paper_tool.hpp"

#include <array>
#include <catch2/catch.hpp>
#include <memory>
#include <stdexcept>
#include <utility>

#include "servo/force/scene_force.hpp"
#include "tests/servo/force/tool_scene.hpp"
#include "tests/support/asset_by_hand.hpp"

namespace spm::paper_tool_test {
namespace {

using test::BoxByHand;

/// A tool of 20 mm on a table of 30 mm, both `full`.
struct PaperScene {
  BoxByHand table{Vector3(0.03, 0.03, 0.03)}, tool{Vector3(0.02, 0.02, 0.02)};
  std::array<const AssetView*, 2> assets{&table.view, &tool.view};
  std::unique_ptr<SampledTool> sampled;
  std::unique_ptr<SceneForce> force;

  PaperScene() {
    ForceScene scene;
    scene.objects = {test::ToolScene::object_of(Method::paper, 2000)};
    scene.added = scene.objects[0];
    scene.tool = ToolSettings{};
    scene.tool->asset = 1;
    auto made = SampledTool::make(tool.view, *scene.tool, 1, 1);
    if (!made) throw std::runtime_error(made.error().message);
    sampled = std::move(*made);
    HandTurning turning;
    turning.torque_cap = turning.force_cap = 100;
    force = std::make_unique<SceneForce>(scene, 1e-3, 0, 0, FeltLimits{}, turning);
    force->take_tool(sampled.get(), 0);
  }
  ContactForce next(const Vector3& position) { return force->next(assets, HandPose{position}); }
};

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

TEST_CASE("The sides of a tool's box count, not the margin about them") {
  const BoxByHand tool(Vector3(0.02, 0.02, 0.02), {0.002, 0.004});
  CHECK(paper_tool_area(tool.view) == Approx(6.0 / 16 * 0.02 * 0.02));
}

}  // namespace
}  // namespace spm::paper_tool_test
