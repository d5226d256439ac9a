// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <memory>
#include <string>
#include <vector>

#include "common/base/error.hpp"
#include "formats/asset/asset.hpp"
#include "formats/scene/scene.hpp"
#include "servo/force/scene_force.hpp"

namespace spm::servo {

/// How many hands may hold the tool, and how many objects it may meet, the tools of others
/// included.
struct ToolRoom {
  std::size_t hands = 1;
  std::size_t objects = 0;
};

/// The settings of a scene's tool, except which asset it is. `scene`: its path; `place`: file and
/// line of the tool, both for messages. Errors: invalid_input, for a tool without a baked file.
[[nodiscard]] Result<ToolSettings> tool_settings(const SceneTool& tool, const std::string& scene,
                                                 const std::string& place);

struct ForceOptions;
struct ForceChoice;

/// Refuses what a command line says of a point or a ball where a scene's tool is an object: probe,
/// and stabilization within an object. Errors: usage.
[[nodiscard]] Result<void> check_beside_tool(const ForceOptions& options, const Scene& scene);

/// A sentence for each key of an object that a point or a ball alone feels, where the tool is an
/// object.
[[nodiscard]] std::vector<std::string> unfelt_by_tool(const ForceChoice& choice);

/// Refuses an object of method paper of another scale than a tool's: eq. 12 to 15 know one for
/// both. `place`: file and line of the object, or of another tool. Errors: invalid_input.
[[nodiscard]] Result<void> check_tool_scale(const ToolSettings& tool, double scale, Method method,
                                            const std::string& place);

/// Refuses a `full` asset of an object that a tool would meet by another method than paper, which
/// reads `sparse` ones alone. `path` is for the message. Errors: invalid_input.
[[nodiscard]] Result<void> check_met_asset(const AssetMetadata& asset, const PlacedObject& object,
                                           const std::string& path);

/// Refuses an asset that can be no tool of a scene: a `full` one where not all objects are of
/// method paper, a `sparse` one where one is, and one of an open mesh, which has no inside. `path`
/// is for the message. Errors: invalid_input.
[[nodiscard]] Result<void> check_tool_asset(const AssetMetadata& asset, const ForceScene& scene,
                                            const ToolSettings& tool, const std::string& path);

/// Whether all objects of a scene are of method paper, and so the tool and what is added.
[[nodiscard]] bool is_by_paper(const ForceScene& scene) noexcept;

/// The samples of an asset that is a tool of a scene: one for all hands, or where each has a tool
/// of its own one for each, null for those that hold another. Errors: those of SampledTool::make.
[[nodiscard]] Result<std::vector<std::unique_ptr<SampledTool>>> sample_tools(
    const AssetView& asset, std::size_t number, const ForceScene& scene, const ToolRoom& room);

/// Refuses tools of hands' own for another number of devices. `place`: file and line of the last
/// tool. Errors: invalid_input.
[[nodiscard]] Result<void> check_tool_count(const ForceScene& scene, std::size_t devices,
                                            const std::string& place);

/// The edges of a tool's bounding box, m of the world.
[[nodiscard]] inline Vector3 tool_size(const AssetMetadata& asset,
                                       const ToolSettings& tool) noexcept {
  return tool.placement.scale * (asset.box_max - asset.box_min);
}

}  // namespace spm::servo
