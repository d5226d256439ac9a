// SPDX-License-Identifier: Apache-2.0
#include "servo/scene/force_choice.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <filesystem>
#include <utility>

#include "common/base/units.hpp"
#include "common/contact/method_mismatch.hpp"
#include "servo/scene/tool_choice.hpp"

namespace spm::servo {

namespace {

/// The stiffest that any device is rated for is 8 N/mm. A hundred times that is a wrong unit.
constexpr double stiffest = 1e6;  // N/m

/// A radius that was written as decimal text may differ by rounding from the recorded one.
constexpr double radius_slack = 1e-9;

/// Why settings and method do not go together, and what to do; empty for none.
std::string in_words(MethodMismatch mismatch, const ForceSettings& settings) {
  const ProbeShape probe = settings.probe();
  switch (mismatch) {
    case MethodMismatch::none:
      return {};
    case MethodMismatch::probe:
      return "method " + std::string(to_string(settings.method)) +
             " knows no probe but a point and a sphere; take method paper, on an asset baked with "
             "--form full, or the probe " +
             text_of({ProbeKind::ball, probe.radius, 0});
    case MethodMismatch::ruled_probe:
      return "the paper's rule " + std::string(to_string(settings.rule)) +
             " is for a point, and the probe is " + text_of(probe) +
             "; take closest-plane, or the probe point";
    case MethodMismatch::volume_of_point:
      return "a point has no volume, of which the force could be the mean; take the probe "
             "sphere:RADIUS or another with a size, or leave the form of the probe's force out";
    case MethodMismatch::friction:
      return "friction by 'stick' and 'slide' is not of method paper; give 'force' and "
             "'depth_gain', or take method spm or proxy";
    case MethodMismatch::texture:
      return "texture by 'amplitude' and 'wavelength' is not of method paper; give 'noise', or "
             "take method spm or proxy";
    case MethodMismatch::paper_friction:
      return "friction by 'force' and 'depth_gain' is of method paper alone; give 'slide' and "
             "'stick', or take method paper";
    case MethodMismatch::paper_texture:
      return "texture by 'noise' is of method paper alone; give 'amplitude' and 'wavelength', or "
             "take method paper";
    case MethodMismatch::density:
      return "'density' is of method paper alone, against a tool that is an object; leave it out, "
             "or take method paper";
    case MethodMismatch::smoothing:
      return "'smoothing' is of method spm alone; leave it out, or take method spm";
  }
  return {};
}

/// What is wrong with settings, and what to do; empty if nothing is.
std::string objection(const ForceSettings& settings, const EffectSettings& effects) {
  if (!(settings.stiffness >= 0 && settings.stiffness <= stiffest)) {
    return "the stiffness is out of range; it must be from 0N/mm to " +
           format_quantity(stiffest, Quantity::stiffness);
  }
  return in_words(mismatch_of(settings, effects), settings);
}

/// The index of a file among those of a choice. A new file is added.
std::size_t asset_number(ForceChoice& choice, const std::string& path) {
  const std::string plain = std::filesystem::path(path).lexically_normal().string();
  const auto found = std::find(choice.assets.begin(), choice.assets.end(), plain);
  if (found != choice.assets.end()) return static_cast<std::size_t>(found - choice.assets.begin());
  choice.assets.push_back(plain);
  return choice.assets.size() - 1;
}

/// The device that forces are for: the one that is served, or else the one that the scene names.
std::optional<ForceDevice> force_device_of(const ForceOptions& options, const SceneDevice& scene) {
  if (options.device || scene.profile == nullptr) return options.device;
  return ForceDevice{scene.profile, scene.profile->stiffness_cap};
}

/// What suits the device, N/m of a world whose metres are `scale` to one of the hand.
double suitable_stiffness(const std::optional<ForceDevice>& device, double scale = 1) {
  return device ? auto_stiffness(*device) / scale : SceneObject::default_stiffness;
}

/// Whether the command line names a method that has no stabilization of its own accord.
bool is_bare(const ForceOptions& options) {
  return options.scene.empty() && options.method && *options.method != default_method;
}

/// What is named, in the loop of the device, or else the default.
StabilizationSettings stabilization_of(const ForceOptions& options, const Scene& scene,
                                       const std::optional<ForceDevice>& device) {
  StabilizationSettings settings = scene.stabilization;
  if (options.stabilization) {
    settings = in_loop_of(scene.stabilization, *options.stabilization);
  } else if (is_bare(options)) {
    settings = {};
  } else if (!scene.stabilization_given) {
    settings = default_stabilization;
  }
  if (!device || device->profile == nullptr) return settings;
  return in_loop_of(*device->profile, settings);
}

/// The method where none is named: effects that one method alone has name it too.
Method method_of(const SceneObject& object, const StabilizationSettings& stabilization) {
  if (object.method) return *object.method;
  return object.effects.smoothing.sigma > 0 || stabilization.potential > 0 ? Method::spm
                                                                           : default_method;
}

/// What touches, the same for all objects.
struct Tool {
  ProbeShape probe;
  PaperProbeForm form = PaperProbeForm::surface;
};

Tool tool_of(const ForceOptions& options, const Scene& scene) {
  return {options.probe.value_or(scene.probe.value_or(ProbeShape{})),
          options.probe_form.value_or(scene.probe_form.value_or(PaperProbeForm::surface))};
}

/// An object by default, with the method that the tool needs.
PlacedObject touched_object(double stiffness, const Tool& tool) {
  PlacedObject object = default_object(stiffness, tool.probe);
  object.force.form = tool.form;
  return object;
}

/// One object as the command line, the scene and the defaults give it together.
PlacedObject placed(const ForceOptions& options, const SceneObject& object, const Tool& tool,
                    double suitable, const std::optional<ForceDevice>& device,
                    const StabilizationSettings& stabilization) {
  PlacedObject placed = touched_object(object.stiffness, tool);
  placed.placement = object.placement;
  placed.movable = object.movable;
  placed.effects = object.effects;
  ForceSettings& force = placed.force;
  force.method = options.method.value_or(method_of(object, stabilization));
  force.rule = options.rule.value_or(object.rule);
  force.density = object.density;
  const bool is_left_open =
      !object.stiffness_given || object.stiffness_chosen || options.stiffness_chosen;
  if (is_left_open) force.stiffness = suitable;
  force.stiffness = options.stiffness.value_or(force.stiffness);
  placed.stiffness_chosen = is_left_open && !options.stiffness && device;
  // A point that sticks is held by the object's own stiffness, if nothing else is said.
  double& sticking = placed.effects.friction.stiffness;
  if (sticking == object.stiffness) sticking = force.stiffness;
  return placed;
}

Result<ForceChoice> choose_asset(const ForceOptions& options) {
  ForceChoice choice;
  const Tool tool = tool_of(options, {});
  choice.probe = tool.probe;
  choice.scene.stabilization = stabilization_of(options, {}, options.device);
  const double suitable = suitable_stiffness(options.device);
  SceneObject object;
  object.effects = default_object(suitable, {}).effects;
  choice.scene.objects = {
      placed(options, object, tool, suitable, options.device, choice.scene.stabilization)};
  choice.scene.added = touched_object(suitable, tool);
  choice.scene.added.stiffness_chosen = options.device.has_value();
  choice.scene.follows_delay = true;
  choice.assets = {options.asset};
  choice.places = {{}};
  if (auto checked = check_settings(choice.scene.objects.front().force); !checked) {
    return tl::make_unexpected(std::move(checked.error()));
  }
  return choice;
}

/// A tool of a scene; its asset comes after the objects'. `place`: file and line.
Result<ToolSettings> chosen_tool(const Scene& scene, const SceneTool& named,
                                 const std::string& place, ForceChoice& choice) {
  auto tool = tool_settings(named, scene.path, place);
  if (!tool) return tool;
  tool->asset = asset_number(choice, named.asset);
  for (std::size_t i = 0; i < choice.scene.objects.size(); ++i) {
    const PlacedObject& object = choice.scene.objects[i];
    auto checked =
        check_tool_scale(*tool, object.placement.scale, object.force.method, choice.places[i]);
    if (!checked) return tl::make_unexpected(std::move(checked.error()));
  }
  return tool;
}

/// The tools of a scene, where they are objects. What applications add follows their method.
Result<void> take_tools(const Scene& scene, ForceChoice& choice) {
  if (!scene.tool) return {};
  const auto place = [&](const SceneTool& tool) {
    return scene.path + ": line " + std::to_string(tool.line) + ": ";
  };
  choice.tool_place = place(*scene.tool);
  auto first = chosen_tool(scene, *scene.tool, choice.tool_place, choice);
  if (!first) return tl::make_unexpected(std::move(first.error()));
  choice.scene.tool = *first;
  for (const SceneTool& named : scene.more_tools) {
    choice.more_tool_places.push_back(place(named));
    auto tool = chosen_tool(scene, named, choice.more_tool_places.back(), choice);
    if (!tool) return tl::make_unexpected(std::move(tool.error()));
    choice.scene.more_tools.push_back(*tool);
  }
  if (is_by_paper(choice.scene)) choice.scene.added.force.method = Method::paper;
  return {};
}

/// The hand's stiffness is that over the scale in the world.
tl::unexpected<Error> too_small_workspace(const std::string& path, double scale, double suitable) {
  return fail(
      ExitCode::invalid_input,
      fmt::format("{}: 'scale' of [workspace] is {:g}, at which what suits the device is {} "
                  "in the world, more than the most, {}; give a scale of at least {:.1g}, "
                  "or name the objects' 'stiffness'",
                  path, scale, format_quantity(suitable, Quantity::stiffness),
                  format_quantity(stiffest, Quantity::stiffness), scale * suitable / stiffest));
}

Result<ForceChoice> choose_scene(const ForceOptions& options) {
  const Result<Scene> scene = read_scene(options.scene);
  if (!scene) return tl::make_unexpected(scene.error());
  const std::optional<ForceDevice> device = force_device_of(options, scene->device);
  if (options.stiffness_chosen && !device) {
    return fail(ExitCode::usage,
                "--stiffness auto is chosen by the device; add 'profile' to "
                "[device] of " +
                    options.scene + ", one of" + device_profile_names());
  }
  const double suitable = suitable_stiffness(device, scene->workspace.scale);
  ForceChoice choice;
  choice.scene_path = scene->path;
  choice.device = scene->device;
  choice.scene.workspace = scene->workspace;
  choice.scene.stabilization = stabilization_of(options, *scene, device);
  const Tool tool = tool_of(options, *scene);
  choice.probe = tool.probe;
  choice.scene.added = touched_object(suitable, tool);
  if (auto fit = check_beside_tool(options, *scene); !fit) {
    return tl::make_unexpected(std::move(fit.error()));
  }
  choice.scene.added.stiffness_chosen = device.has_value();
  choice.scene.follows_delay = !scene->delay_given;
  for (const SceneObject& object : scene->objects) {
    const std::string place = scene->path + ": line " + std::to_string(object.line) + ": ";
    if (object.asset.empty()) {
      return fail(ExitCode::invalid_input,
                  place + "the object has no 'asset'; bake its mesh with spm-bake build " +
                      object.mesh + " --scene " + scene->path + ", and name the baked file");
    }
    PlacedObject made = placed(options, object, tool, suitable, device, choice.scene.stabilization);
    if (made.force.stiffness == suitable && suitable > stiffest) {
      return too_small_workspace(scene->path, scene->workspace.scale, suitable);
    }
    if (auto checked = check_settings(made.force, made.effects, place); !checked) {
      return tl::make_unexpected(std::move(checked.error()));
    }
    made.asset = asset_number(choice, object.asset);
    choice.scene.objects.push_back(made);
    choice.places.push_back(place);
  }
  if (auto taken = take_tools(*scene, choice); !taken) return tl::make_unexpected(taken.error());
  choice.unfelt = unfelt_by_tool(choice);
  return choice;
}

}  // namespace

const char* to_string(Method method) noexcept {
  switch (method) {
    case Method::spm:
      return "spm";
    case Method::paper:
      return "paper";
    case Method::proxy:
      return "proxy";
  }
  return "";
}

const char* to_string(PaperRule rule) noexcept {
  return paper_rule_words.at(static_cast<std::size_t>(rule));
}

const char* to_string(PaperProbeForm form) noexcept {
  return form == PaperProbeForm::volume ? "volume" : "surface";
}

const char* to_string(AssetForm form) noexcept {
  return form == AssetForm::full ? "full" : "sparse";
}

Result<ForceChoice> choose_forces(const ForceOptions& options) {
  if (!options.asset.empty() && !options.scene.empty()) {
    return fail(ExitCode::usage, "--asset and --scene exclude each other; give one of them");
  }
  if (options.asset.empty() && options.scene.empty()) {
    return fail(ExitCode::usage,
                "nothing is there to touch; give --asset FILE.spm.exr or --scene SCENE.toml");
  }
  return options.scene.empty() ? choose_asset(options) : choose_scene(options);
}

std::string place_of_asset(const ForceChoice& choice, std::size_t which) {
  for (std::size_t i = 0; i < choice.scene.objects.size(); ++i) {
    if (choice.scene.objects[i].asset == which) return choice.places[i];
  }
  for (std::size_t k = 0; k < tools_of(choice.scene); ++k) {
    if (tool_of(choice.scene, k)->asset == which) return place_of_tool(choice, k);
  }
  return {};
}

const std::string& place_of_tool(const ForceChoice& choice, std::size_t hand) {
  const bool own = hand > 0 && hand <= choice.more_tool_places.size();
  return own ? choice.more_tool_places[hand - 1] : choice.tool_place;
}

Result<void> check_settings(const ForceSettings& settings, const EffectSettings& effects,
                            const std::string& place) {
  const std::string cause = objection(settings, effects);
  if (cause.empty()) return {};
  return fail(place.empty() ? ExitCode::usage : ExitCode::invalid_input, place + cause);
}

Result<void> check_asset(const AssetMetadata& asset, const ForceSettings& settings,
                         const std::string& path, double scale) {
  if (settings.method == Method::paper && asset.form != AssetForm::full) {
    return fail(ExitCode::invalid_input,
                path +
                    ": is a sparse asset, which method paper cannot read; bake the mesh again with "
                    "--form full, or take method spm");
  }
  ProbeShape probe = settings.probe();
  probe.radius /= scale;
  probe.length /= scale;
  if (probe.radius > asset.probe_radius * (1 + radius_slack)) {
    return fail(ExitCode::invalid_input,
                path + ": was baked for probe " +
                    text_of({ProbeKind::ball, asset.probe_radius, 0}) +
                    ", whose radius is smaller than that of " + text_of(probe) +
                    (scale == 1 ? "" : ", the scene's over the object's scale") +
                    "; bake the mesh again with --probe and the larger radius");
  }
  return {};
}

Result<void> check_asset(const AssetMetadata& asset, const ForceChoice& choice, std::size_t which) {
  for (std::size_t i = 0; i < choice.scene.objects.size(); ++i) {
    const PlacedObject& object = choice.scene.objects[i];
    if (object.asset != which) continue;
    auto checked = check_asset(asset, object.force, choice.places[i] + choice.assets[which],
                               object.placement.scale);
    if (checked && choice.scene.tool) {
      checked = check_met_asset(asset, object, choice.places[i] + choice.assets[which]);
    }
    if (!checked) return checked;
  }
  for (std::size_t k = 0; k < tools_of(choice.scene); ++k) {
    const ToolSettings& tool = *tool_of(choice.scene, k);
    if (tool.asset != which) continue;
    auto checked = check_tool_asset(asset, choice.scene, tool,
                                    place_of_tool(choice, k) + choice.assets[which]);
    if (!checked) return checked;
  }
  return {};
}

}  // namespace spm::servo
