// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <memory>
#include <stdexcept>
#include <utility>

#include "servo/force/scene_force.hpp"
#include "tests/support/asset_by_hand.hpp"

namespace spm::test {

/// A small cube in a hand, above a large one that stands with its top at z = 0; both have a form in
/// closed form. Asset 0 is the table, asset 1 the tool.
struct ToolScene {
  static constexpr double table_size = 0.04, tool_size = 0.012, tick = 1e-3;

  explicit ToolScene(Method method = Method::proxy, double stiffness = 1000) {
    scene.objects = {object_of(method, stiffness)};
    scene.objects[0].placement.position = {0, 0, -table_size / 2};
    scene.added = object_of(method, stiffness);
    scene.tool = ToolSettings{};
    scene.tool->asset = 1;
    scene.tool->spacing = 0.0006;
    turning = {true, 0.3, 0, 1e-3, 8};
  }

  static PlacedObject object_of(Method method, double stiffness) {
    PlacedObject object;
    object.force.method = method;
    object.force.stiffness = stiffness;
    return object;
  }

  /// Makes the tool's samples and the force law of the settings as they are now.
  void begin(std::size_t room = 0) {
    auto made = SampledTool::make(tool_cube.view, *scene.tool, 1, scene.objects.size() + room);
    if (!made) throw std::runtime_error(made.error().message);
    sampled = std::move(*made);
    force = std::make_unique<SceneForce>(scene, tick, 0.0, room, FeltLimits{}, turning);
    force->take_tool(sampled.get(), 0);
  }

  ContactForce next(const Vector3& position,
                    const Eigen::Quaterniond& orientation = Eigen::Quaterniond::Identity()) {
    return force->next(assets, HandPose{position, orientation});
  }
  /// The last of many ticks at a pose.
  ContactForce settle(const Vector3& position,
                      const Eigen::Quaterniond& orientation = Eigen::Quaterniond::Identity(),
                      int ticks = 200) {
    ContactForce contact;
    for (int i = 0; i < ticks; ++i) contact = next(position, orientation);
    return contact;
  }

  SparseCubeByHand table{table_size}, tool_cube{tool_size};
  std::array<const AssetView*, 2> assets{&table.view, &tool_cube.view};
  ForceScene scene;
  HandTurning turning;
  std::unique_ptr<SampledTool> sampled;
  std::unique_ptr<SceneForce> force;
};

}  // namespace spm::test
