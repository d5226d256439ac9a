// SPDX-License-Identifier: Apache-2.0
#include "servo/loop/run_messages.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <limits>
#include <optional>
#include <utility>

#include "common/base/units.hpp"
#include "common/contact/stable_stiffness.hpp"
#include "servo/devices/finder/device_list.hpp"
#include "servo/force/tool_coupling.hpp"
#include "servo/scene/tool_choice.hpp"

namespace spm::servo {

namespace {

/// So that what a scene computes from the stable stiffness itself is not above it.
constexpr double rounding = 1e-9;
/// m: objects that the hand passes on a shorter way cannot be felt.
constexpr double hardly_a_motion = 1e-4;
/// Of an object's size, what stands for its error where the asset promises none.
constexpr double unresolved_share = 1e-5;

/// How forces are made, as one clause.
std::string forces_text(const ForceScene& scene) {
  const ForceSettings& first = scene.objects.front().force;
  const bool alike = std::all_of(scene.objects.begin(), scene.objects.end(), [&](const auto& o) {
    return o.force.method == first.method && o.force.stiffness == first.stiffness;
  });
  std::string text = alike ? fmt::format("by {} at {}", to_string(first.method),
                                         format_quantity(first.stiffness, Quantity::stiffness))
                           : std::string("each object by its own method");
  return text + (scene.stabilization.any() ? ", stabilized" : ", not stabilized");
}

/// How far the samples of the coarsest tool are apart, m of the world.
double widest_spacing(const ForceChoice& choice, const std::vector<KeeperReport>& assets) {
  double widest = 0;
  for (std::size_t k = 0; k < tools_of(choice.scene); ++k) {
    const std::vector<ToolReport>& tools = assets[tool_of(choice.scene, k)->asset].tools;
    if (k < tools.size()) widest = std::max(widest, tools[k].spacing);
  }
  return widest;
}

/// A sentence for each object that may pass between the samples of the tool.
std::vector<std::string> sample_warnings(const ForceChoice& choice,
                                         const std::vector<KeeperReport>& assets) {
  std::vector<std::string> list;
  const double spacing = widest_spacing(choice, assets);
  for (std::size_t i = 0; i < choice.scene.objects.size(); ++i) {
    const PlacedObject& object = choice.scene.objects[i];
    const AssetMetadata& asset = assets[object.asset].metadata;
    const double narrow = object.placement.scale * (asset.box_max - asset.box_min).minCoeff();
    if (narrow >= spacing) continue;
    list.push_back(choice.places[i] + "the object is " + format_quantity(narrow, Quantity::length) +
                   " wide, and the tool's samples are " +
                   format_quantity(spacing, Quantity::length) +
                   " apart, so that it may pass between them: give [tool] a smaller 'spacing' or "
                   "'scale', or more 'samples'");
  }
  return list;
}

/// Adds a sentence for what a tool names of its coupling and does not get, or had better not.
void add_coupling_warnings(const ForceChoice& choice, std::size_t hand,
                           const DeviceCapabilities& can, std::vector<std::string>& list) {
  const ToolSettings& tool = *tool_of(choice.scene, hand);
  constexpr double tick = 1e-3;
  const ToolLoop loop{tick,
                      can.encoder_step,
                      choice.scene.added.force.stiffness,
                      1,
                      choice.scene.stabilization.device_mass,
                      felt_limits(force_device(can), tick),
                      hand_turning(can)};
  const ToolCoupling used = tool_coupling(tool, loop);
  const auto add = [&](const char* key, double asked, double got, Quantity kind, const char* why) {
    if (!(asked > got * (1 + rounding))) return;
    list.push_back(place_of_tool(choice, hand) + "'" + key + "' of [tool] asks for " +
                   format_quantity(asked, kind) + ", more than the " + format_quantity(got, kind) +
                   " that " + can.name + " " + why);
  };
  add("coupling", tool.coupling, used.stiffness, Quantity::stiffness,
      "renders stably: it is held to that (stiffness_cap= of the device changes it)");
  const double border = loop.limits.stable / stiffness_margin;
  if (tool.coupling > 0 && used.stiffness > border * (1 + rounding)) {
    list.push_back(place_of_tool(choice, hand) + "'coupling' of [tool] is " +
                   format_quantity(used.stiffness, Quantity::stiffness) + ", more than the " +
                   format_quantity(border, Quantity::stiffness) + " that " + can.name +
                   " holds stably by simulation, so that it may shake and push: lower it, or "
                   "leave it to \"auto\" (stiffness_cap= of the device holds it, too)");
  }
  add("turning", tool.turning, used.turning, Quantity::turning_stiffness,
      "bears by its inertia and its torque cap: it is held to that");
}

/// The longest edge of a box about an object, m of the world.
double longest_edge(const PlacedObject& object, const AssetMetadata& asset) {
  return object.placement.scale * (asset.box_max - asset.box_min).maxCoeff();
}

}  // namespace

std::string start_message(const RunOptions& options, const ForceScene& scene,
                          const std::vector<KeeperReport>& assets,
                          const std::vector<std::string>& paths,
                          const std::vector<Device*>& devices) {
  std::string text = "serving ";
  if (assets.size() == 1) {
    const std::optional<double>& tolerance = assets.front().metadata.tolerance;
    text += paths.front();
    if (tolerance) text += " (tolerance " + format_quantity(*tolerance, Quantity::length) + ")";
  } else {
    text += fmt::format("a scene of {} assets", assets.size());
  }
  for (std::size_t k = 0; k < tools_of(scene); ++k) {
    const char* before = k == 0 ? (tools_meet(scene) ? " to the tools " : " to the tool ") : ", ";
    text += before + paths[tool_of(scene, k)->asset];
  }
  text += " " + forces_text(scene) + fmt::format(", at {:g} Hz on ", options.rate_hz);
  for (std::size_t i = 0; i < devices.size(); ++i) {
    text += (i > 0 ? ", " : "") + devices[i]->capabilities().name;
  }
  text += options.duration > 0 ? fmt::format(" for {:g} s", options.duration) : "";
  return text + "; end it with Ctrl-C";
}

bool nothing_plugged_in(const RunOptions& options, const ForceChoice& choice,
                        const std::vector<Device*>& devices) {
  const std::string asked = options.devices.empty() ? device_of(choice.device) : options.devices[0];
  return asked == "auto" && devices.front()->capabilities().name == "sim";
}

std::vector<std::string> paper_warnings(const ForceChoice& choice) {
  std::vector<std::string> list;
  bool ruled = false, by_volume = false;
  for (const PlacedObject& object : choice.scene.objects) {
    if (object.force.method == Method::paper) return {};
    ruled = ruled || object.force.rule != PaperRule::closest_plane;
    by_volume = by_volume || object.force.form != PaperProbeForm::surface;
  }
  const auto add = [&](const char* what) {
    list.push_back(std::string(what) +
                   " is for objects of method paper, and there is none: it changes nothing; leave "
                   "it out, or take --method paper");
  };
  if (ruled) add("the paper's rule (--paper-rule, or 'paper_rule' of an object)");
  if (by_volume) add("the form of the probe's force (--paper-probe, or 'paper_probe' of [tool])");
  return list;
}

std::vector<std::string> stiffness_warnings(const ForceChoice& choice,
                                            const std::vector<Device*>& devices) {
  std::vector<std::string> list;
  const double wanted = stiffness_at_hand(choice.scene);
  for (const Device* device : devices) {
    const DeviceCapabilities& can = device->capabilities();
    if (wanted > can.stiffness_cap) {
      list.push_back(can.name + ": the scene asks for " +
                     format_quantity(wanted, Quantity::stiffness) + " at the hand, more than the " +
                     format_quantity(can.stiffness_cap, Quantity::stiffness) +
                     " that this device renders stably: what is stiffer is held to that "
                     "(stiffness_cap= of the device changes it)");
    }
    const double felt = std::min(wanted, can.stiffness_cap);
    const double stable = auto_stiffness(force_device(can));
    if (felt > stable * (1 + rounding)) {
      list.push_back(can.name + ": " + format_quantity(felt, Quantity::stiffness) +
                     " at the hand is more than the " +
                     format_quantity(stable, Quantity::stiffness) +
                     " that it holds stably by simulation, so that it may shake and push: lower "
                     "the stiffness, or leave it to --stiffness auto");
    }
  }
  return list;
}

std::vector<std::string> workspace_warnings(const ForceChoice& choice,
                                            const std::vector<KeeperReport>& assets,
                                            const std::vector<Device*>& devices) {
  std::vector<std::string> list;
  const double scale = choice.scene.workspace.scale;
  double largest = 0, finest = std::numeric_limits<double>::infinity();
  for (const PlacedObject& object : choice.scene.objects) {
    const AssetMetadata& asset = assets[object.asset].metadata;
    const double edge = longest_edge(object, asset);
    largest = std::max(largest, edge);
    finest = std::min(finest, asset.tolerance ? object.placement.scale * *asset.tolerance
                                              : unresolved_share * edge);
  }
  const std::string key = choice.scene_path + ": 'scale' of [workspace] is " +
                          fmt::format("{:g}", scale) + ", so that ";
  if (largest > 0 && largest < hardly_a_motion * scale) {
    list.push_back(key + "the largest object, " + format_quantity(largest, Quantity::length) +
                   ", is passed by the hand on a way of " +
                   format_quantity(largest / scale, Quantity::length) +
                   ", and nothing can be felt: lower it, so that the hand's workspace is about as "
                   "large as what it touches");
  }
  for (const Device* device : devices) {
    const DeviceCapabilities& can = device->capabilities();
    const double span = 2 * can.workspace.maxCoeff() * scale;
    if (!(span > 0 && span < finest)) continue;
    list.push_back(key + "the whole workspace of " + can.name + " is " +
                   format_quantity(span, Quantity::length) +
                   " of the world, less than the error of any object: raise it");
  }
  return list;
}

std::vector<std::string> tool_warnings(const ForceChoice& choice,
                                       const std::vector<KeeperReport>& assets,
                                       const std::vector<Device*>& devices) {
  if (!choice.scene.tool) return {};
  std::vector<std::string> list = choice.unfelt;
  for (std::string& text : sample_warnings(choice, assets)) list.push_back(std::move(text));
  for (std::size_t i = 0; i < devices.size(); ++i) {
    const DeviceCapabilities& can = devices[i]->capabilities();
    const ToolSettings& tool = *tool_of(choice.scene, i);
    const double longest = tool_size(assets[tool.asset].metadata, tool).maxCoeff();
    add_coupling_warnings(choice, i, can, list);
    if (!can.turns) {
      list.push_back(can.name +
                     " does not tell how its tool is turned: the scene's tool keeps the "
                     "orientation that 'pose' of [tool] gives, and only moves");
    }
    const double edge = 2 * can.workspace.maxCoeff() * choice.scene.workspace.scale;
    if (edge > 0 && longest > edge) {
      list.push_back(place_of_tool(choice, i) + "the tool is " +
                     format_quantity(longest, Quantity::length) + " long, and the workspace of " +
                     can.name + " " + format_quantity(edge, Quantity::length) +
                     ": lower 'scale' of [tool], or raise 'scale' of [workspace]");
    }
  }
  return list;
}

std::vector<std::string> tool_notes(const ForceChoice& choice,
                                    const std::vector<Device*>& devices) {
  std::vector<std::string> list;
  for (std::size_t i = 0; i < devices.size() && choice.scene.tool; ++i) {
    const DeviceCapabilities& can = devices[i]->capabilities();
    const bool capped = !(tool_of(choice.scene, i)->torque_cap > 0);
    const bool gives = hand_turning(can).torque_cap > 0;
    if (!can.turns || (gives && !capped)) continue;
    if (!(can.force_cap > 0)) {
      list.push_back(can.name +
                     " gives neither force nor torque: what the tool meets is told in contacts and "
                     "reactions, and the hand feels nothing");
      continue;
    }
    const std::string cause = gives ? place_of_tool(choice, i) + "'torque_cap' of [tool] is 0"
                                    : can.name + " gives no torque";
    list.push_back(cause +
                   ": the torque is left out, so that the hand gets the force alone; the objects "
                   "still turn the tool, as a spring between it and the hand lets them");
  }
  return list;
}

}  // namespace spm::servo
