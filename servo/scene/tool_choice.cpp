// SPDX-License-Identifier: Apache-2.0
#include "servo/scene/tool_choice.hpp"

#include <algorithm>
#include <cmath>
#include <cstddef>

#include "common/base/units.hpp"
#include "common/contact/turn_limit.hpp"
#include "servo/scene/force_choice.hpp"

namespace spm::servo {

namespace {

/// Largest diagonal of a tool, in spacings: beyond it there are millions of samples.
constexpr double finest_share = 4000;

/// Scales that were written as decimal text may differ by rounding.
constexpr double scale_slack = 1e-9;

}  // namespace

Result<ToolSettings> tool_settings(const SceneTool& tool, const std::string& scene,
                                   const std::string& place) {
  if (tool.asset.empty()) {
    return fail(ExitCode::invalid_input,
                place + "the tool has no 'asset'; bake its mesh with spm-bake build " + tool.mesh +
                    " --scene " + scene + ", and name the baked file");
  }
  ToolSettings settings;
  settings.placement = tool.placement;
  settings.coupling = tool.coupling.value_or(0);
  settings.turning = tool.turning.value_or(0);
  settings.torque_cap = tool.torque_cap.value_or(settings.torque_cap);
  settings.spacing = tool.spacing / tool.placement.scale;
  settings.samples = tool.samples;
  settings.budget = tool.budget;
  return settings;
}

Result<void> check_beside_tool(const ForceOptions& options, const Scene& scene) {
  if (!scene.tool) return {};
  const std::string because =
      ": the tool of " + scene.path + " is an object of its own ('asset' of [tool]); leave the ";
  const char* in_scene = "option out, or name a probe in the scene";
  if (options.probe) return fail(ExitCode::usage, "--probe" + because + in_scene);
  if (options.probe_form) return fail(ExitCode::usage, "--paper-probe" + because + in_scene);
  if (!options.stabilization) return {};
  const bool coupled = options.stabilization->coupling > 0;
  if (!coupled && !(options.stabilization->potential > 0)) return {};
  return fail(ExitCode::usage, std::string("--stabilization ") +
                                   (coupled ? "coupling" : "potential") + because +
                                   "word out: damping and passivity are for all tools");
}

std::vector<std::string> unfelt_by_tool(const ForceChoice& choice) {
  std::vector<std::string> list;
  for (std::size_t i = 0; i < choice.scene.objects.size() && choice.scene.tool; ++i) {
    const PlacedObject& object = choice.scene.objects[i];
    const EffectSettings& effects = object.effects;
    const auto add = [&](const char* key, bool given) {
      if (!given) return;
      list.push_back(choice.places[i] + "'" + key +
                     "' is for a point or a ball: the tool is an object, and feels this one "
                     "without it; leave the key out");
    };
    add("smoothing", effects.smoothing.sigma > 0);
    add("turn_limit", effects.turn.rate != default_turn_rate);
    add("friction", effects.friction_force > 0);
    add("texture", effects.texture_noise > 0);
    add("paper_rule",
        object.force.method == Method::paper && object.force.rule != PaperRule::closest_plane);
  }
  return list;
}

bool is_by_paper(const ForceScene& scene) noexcept {
  return std::all_of(scene.objects.begin(), scene.objects.end(), [](const PlacedObject& object) {
    return object.force.method == Method::paper;
  });
}

Result<std::vector<std::unique_ptr<SampledTool>>> sample_tools(const AssetView& asset,
                                                               std::size_t number,
                                                               const ForceScene& scene,
                                                               const ToolRoom& room) {
  std::vector<std::unique_ptr<SampledTool>> made;
  const std::size_t hands = tools_meet(scene) ? 1 : room.hands;
  for (std::size_t k = 0; k < tools_of(scene); ++k) {
    made.emplace_back();
    const ToolSettings& tool = *tool_of(scene, k);
    if (tool.asset != number) continue;
    auto sampled = SampledTool::make(asset, tool, hands, room.objects);
    if (!sampled) return tl::make_unexpected(std::move(sampled.error()));
    made.back() = std::move(*sampled);
  }
  return made;
}

Result<void> check_tool_count(const ForceScene& scene, std::size_t devices,
                              const std::string& place) {
  const std::size_t tools = tools_of(scene);
  if (!tools_meet(scene) || tools == devices) return {};
  return fail(ExitCode::invalid_input,
              place + "the scene names " + std::to_string(tools) + " tools for " +
                  std::to_string(devices) + (devices == 1 ? " device" : " devices") +
                  "; give each device its [[tool]], in the order of --device, or all of them one "
                  "[tool]");
}

Result<void> check_tool_scale(const ToolSettings& tool, double scale, Method method,
                              const std::string& place) {
  const double share = scale / tool.placement.scale;
  if (method != Method::paper || std::abs(share - 1) <= scale_slack) return {};
  return fail(ExitCode::invalid_input,
              place +
                  "method paper knows one 'scale' for a tool and what it meets; give object and "
                  "[tool] the same, or take method proxy for the object");
}

Result<void> check_met_asset(const AssetMetadata& asset, const PlacedObject& object,
                             const std::string& path) {
  if (object.force.method == Method::paper || asset.form != AssetForm::full) return {};
  return fail(ExitCode::invalid_input,
              path +
                  ": is a full asset, which a tool can meet by method paper alone; bake the mesh "
                  "again with --form sparse, or take method paper for object and tool");
}

Result<void> check_tool_asset(const AssetMetadata& asset, const ForceScene& scene,
                              const ToolSettings& tool, const std::string& path) {
  const auto papers = std::count_if(
      scene.objects.begin(), scene.objects.end(),
      [](const PlacedObject& object) { return object.force.method == Method::paper; });
  if (asset.form == AssetForm::full && !is_by_paper(scene)) {
    return fail(ExitCode::invalid_input,
                path +
                    ": is a full asset, whose surface cannot be sampled as a tool; bake the mesh "
                    "again with --form sparse, or take method paper for all objects");
  }
  if (asset.form != AssetForm::full && papers > 0) {
    return fail(ExitCode::invalid_input,
                path +
                    ": is a sparse tool, which method paper cannot read; bake the mesh again with "
                    "--form full, or take method proxy or spm for all objects");
  }
  const double spacing = tool.spacing;
  if (spacing > 0 && asset.diagonal > finest_share * spacing) {
    return fail(ExitCode::invalid_input,
                path +
                    ": 'spacing' of [tool] is finer than a tool of this size can be sampled; "
                    "give at least " +
                    format_quantity(tool.placement.scale * asset.diagonal / finest_share,
                                    Quantity::length));
  }
  if (!asset.closed) {
    return fail(ExitCode::invalid_input,
                path +
                    ": is of an open mesh, so that it has no inside and can be no tool; close "
                    "the mesh's " +
                    std::to_string(asset.border_edges) + " border edges, and bake it again");
  }
  return {};
}

}  // namespace spm::servo
