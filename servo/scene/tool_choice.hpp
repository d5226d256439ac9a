// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <string>

#include "common/base/error.hpp"
#include "formats/asset/asset.hpp"
#include "formats/scene/scene.hpp"
#include "servo/force/scene_force.hpp"

namespace spm::servo {

/// How many hands may hold the tool, and how many objects it may meet.
struct ToolRoom {
  std::size_t hands = 1;
  std::size_t objects = 0;
};

/// The settings of a scene's tool, except which asset it is. `scene`: its path; `place`: file and
/// line of the tool, both for messages. Errors: invalid_input, for a tool without a baked file and
/// for a coupling that no device bears.
[[nodiscard]] Result<ToolSettings> tool_settings(const SceneTool& tool, const std::string& scene,
                                                 const std::string& place);

/// Refuses an object of method paper of another scale than the tool's: eq. 12 to 15 know one for
/// both. `place`: file and line of the object. Errors: invalid_input.
[[nodiscard]] Result<void> check_tool_scale(const ToolSettings& tool, const PlacedObject& object,
                                            const std::string& place);

/// Refuses a `full` asset of an object that a tool would meet by another method than paper, which
/// reads `sparse` ones alone. `path` is for the message. Errors: invalid_input.
[[nodiscard]] Result<void> check_met_asset(const AssetMetadata& asset, const PlacedObject& object,
                                           const std::string& path);

/// Refuses an asset that can be no tool of a scene: a `full` one where not all objects are of
/// method paper, a `sparse` one where one is, and one of an open mesh, which has no inside. `path`
/// is for the message. Errors: invalid_input.
[[nodiscard]] Result<void> check_tool_asset(const AssetMetadata& asset, const ForceScene& scene,
                                            const std::string& path);

/// Whether this asset is the tool of a scene.
[[nodiscard]] inline bool is_tool(const ForceScene& scene, std::size_t which) noexcept {
  return scene.tool && scene.tool->asset == which;
}

/// The edges of a tool's bounding box, m of the world.
[[nodiscard]] inline Vector3 tool_size(const AssetMetadata& asset,
                                       const ToolSettings& tool) noexcept {
  return tool.placement.scale * (asset.box_max - asset.box_min);
}

}  // namespace spm::servo
