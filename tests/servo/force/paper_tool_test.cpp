// SPDX-License-Identifier: Apache-2.0
#include "servo/force/paper_tool.hpp"

#include <array>
#include <catch2/catch.hpp>

#include "servo/force/scene_force.hpp"
#include "servo/force/tool_check.hpp"
#include "tests/servo/force/tool_scene.hpp"
#include "tests/support/asset_by_hand.hpp"

namespace spm::paper_tool_test {
namespace {

using test::BoxByHand;

TEST_CASE("By method paper a tool feels one force at the centre of the volume that is shared") {
  const BoxByHand table(Vector3(0.06, 0.06, 0.03)), tool(Vector3(0.02, 0.02, 0.02));
  ForceScene scene;
  PlacedObject object;
  object.force.method = Method::paper;
  object.force.stiffness = 2000;
  scene.objects = {object};
  scene.added = object;
  scene.tool = ToolSettings{};
  scene.tool->asset = 1;
  const std::array<const AssetView*, 2> assets{&table.view, &tool.view};
  REQUIRE(check_tool(*scene.tool, scene.objects, assets).has_value());
  auto made = SampledTool::make(tool.view, *scene.tool, 1, 1);
  REQUIRE(made.has_value());
  HandTurning turning;
  turning.torque_cap = turning.force_cap = 100;
  SceneForce force(scene, 1e-3, 0, 0, {}, turning);
  force.take_tool(made->get(), 0);
  CHECK_FALSE(force.next(assets, HandPose{{0.002, 0, 0.0255}}).contact);
  constexpr double depth = 0.0005;
  const ContactForce contact = force.next(assets, HandPose{{0.002, 0.001, 0.025 - depth}});
  REQUIRE(contact.contact);
  const double wanted = 2000 / paper_tool_area(tool.view) * 0.02 * 0.02 * depth;
  CHECK(contact.force.z() == Approx(wanted).epsilon(0.05));
  CHECK(contact.force.head<2>().norm() < 1e-9);
  // The tool is held at its middle, under which the volume lies.
  CHECK(contact.torque.norm() < 0.02 * wanted * 0.01);
  CHECK((force.reaction(0).force + contact.force).norm() < 1e-9);
  REQUIRE(force.tool().patch_count == 1);
  CHECK(force.tool().patches[0].normal.z() == Approx(1));
}

TEST_CASE("Assets that a tool's method cannot use are refused with a cure") {
  const BoxByHand full(Vector3(0.02, 0.02, 0.02));
  const test::TiledCubeByHand sparse(0.02);
  ToolSettings tool;
  tool.asset = 1;
  std::array<PlacedObject, 1> objects{test::ToolScene::object_of(Method::paper, 1000)};
  const auto refused = [&](const AssetView& object, const AssetView& held) {
    const std::array<const AssetView*, 2> assets{&object, &held};
    const auto checked = check_tool(tool, objects, assets);
    return checked ? std::string() : checked.error().message;
  };
  CHECK(refused(full.view, full.view).empty());
  CHECK(refused(sparse.view, full.view).find("--form full") != std::string::npos);
  CHECK(refused(full.view, sparse.view).find("--form full") != std::string::npos);
  objects[0].placement.scale = 2;
  CHECK(refused(full.view, full.view).find("one scale") != std::string::npos);
  objects[0] = test::ToolScene::object_of(Method::proxy, 1000);
  CHECK(refused(sparse.view, sparse.view).empty());
  CHECK(refused(full.view, sparse.view).find("paper") != std::string::npos);
  CHECK(refused(sparse.view, full.view).find("paper") != std::string::npos);
}

}  // namespace
}  // namespace spm::paper_tool_test
