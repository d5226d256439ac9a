// SPDX-License-Identifier: Apache-2.0
#include "servo/record/recorded_scene.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <nlohmann/json.hpp>
#include <string_view>

#include "formats/files/json_fields.hpp"
#include "formats/files/json_text.hpp"

namespace spm::servo {

namespace {

using Json = nlohmann::ordered_json;

// A field that is added to one of these must be recorded below, or replays go wrong.
static_assert(sizeof(ForceSettings) == 72);
static_assert(sizeof(EffectSettings) == 128);
static_assert(sizeof(StabilizationSettings) == 72);
static_assert(sizeof(ToolSettings) == 144);

constexpr double huge = 1e12;
constexpr double unit_slack = 1e-6;
constexpr std::array<const char*, 3> methods{"spm", "paper", "proxy"};
constexpr std::array<const char*, 2> probe_forms_recorded{"surface", "volume"};
constexpr std::array<const char*, 2> probe_kinds{"ball", "capsule"};
constexpr std::array<const char*, 2> velocities{"estimate", "difference"};

/// One walk over the fields of a struct, for writing and for reading.
class Writer {
 public:
  void number(const char* key, double& value, double /*low*/) { json_[key] = value; }
  [[nodiscard]] static bool has(const char* /*key*/) { return true; }
  void integer(const char* key, std::uint64_t& value) { json_[key] = value; }
  void flag(const char* key, bool& value) { json_[key] = value; }
  template <class Word, std::size_t count>
  void word(const char* key, Word& value, const std::array<const char*, count>& words) {
    json_[key] = words[static_cast<std::size_t>(value)];
  }
  [[nodiscard]] const Json& json() const { return json_; }

 private:
  Json json_ = Json::object();
};

class Reader {
 public:
  Reader(const Json& json, const char* place, std::string& problem)
      : fields_(json, place, problem) {}
  void number(const char* key, double& value, double low) {
    value = fields_.number(key, low, huge);
  }
  [[nodiscard]] bool has(const char* key) const { return !fields_.optional(key).is_null(); }
  void integer(const char* key, std::uint64_t& value) {
    value = fields_.integer(key, 0, std::numeric_limits<std::uint64_t>::max());
  }
  void flag(const char* key, bool& value) { value = fields_.flag(key); }
  template <class Word, std::size_t count>
  void word(const char* key, Word& value, const std::array<const char*, count>& words) {
    const auto found = std::find(words.begin(), words.end(), fields_.text(key));
    if (found == words.end()) return fields_.wrong(key, "a known word");
    value = static_cast<Word>(found - words.begin());
  }

 private:
  JsonFields fields_;
};

template <class Fields>
void walk(Fields& fields, Placement& placement) {
  constexpr std::array position{"x", "y", "z"};
  for (int axis = 0; axis < 3; ++axis) {
    fields.number(position[static_cast<std::size_t>(axis)], placement.position[axis], -huge);
  }
  fields.number("qw", placement.rotation.w(), -2);
  fields.number("qx", placement.rotation.x(), -2);
  fields.number("qy", placement.rotation.y(), -2);
  fields.number("qz", placement.rotation.z(), -2);
  fields.number("scale", placement.scale, 1e-12);
}

template <class Fields>
void walk(Fields& fields, StabilizationSettings& settings) {
  fields.number("damping_share", settings.damping_share, 0);
  fields.number("delay_ticks", settings.delay_ticks, 0);
  fields.number("lag_s", settings.lag, 0);
  fields.number("coupling_n_m", settings.coupling, 0);
  fields.number("coupling_damping_n_s_m", settings.coupling_damping, 0);
  fields.flag("passivity", settings.passivity);
  fields.number("potential_m", settings.potential, 0);
  fields.word("velocity", settings.velocity, velocities);
  fields.number("device_mass_kg", settings.device_mass, 1e-12);
}

template <class Fields>
void walk(Fields& fields, EffectSettings& effects) {
  fields.number("friction_stick", effects.friction.stick, 0);
  fields.number("friction_slide", effects.friction.slide, 0);
  fields.number("friction_n_m", effects.friction.stiffness, 0);
  fields.number("damping_n_s_m", effects.damping, 0);
  fields.number("texture_amplitude_m", effects.texture.amplitude, 0);
  fields.number("texture_wavelength_m", effects.texture.wavelength, 0);
  fields.integer("texture_seed", effects.texture.seed);
  fields.number("smoothing_m", effects.smoothing.sigma, 0);
  std::uint64_t samples = effects.smoothing.samples;
  fields.integer("smoothing_samples", samples);
  effects.smoothing.samples =
      static_cast<std::uint32_t>(std::clamp<std::uint64_t>(samples, 1, max_smoothing_samples));
  fields.number("turn_rad_s", effects.turn.rate, 0);
  fields.number("turn_jump_rad", effects.turn.jump, 0);
  fields.number("turn_step_m", effects.turn.step, 0);
  fields.number("friction_force_n", effects.friction_force, 0);
  fields.number("friction_depth_1_m", effects.friction_depth, 0);
  fields.number("texture_noise_m", effects.texture_noise, 0);
  fields.integer("noise_seed", effects.noise_seed);
}

/// A number of things, as a file has it.
template <class Fields>
void count(Fields& fields, const char* key, std::size_t& value) {
  std::uint64_t number = value;
  fields.integer(key, number);
  value = static_cast<std::size_t>(number);
}

/// A limit that may be infinite, which JSON has no number for.
template <class Fields>
void limit(Fields& fields, const char* flag, const char* key, double& value) {
  bool given = std::isfinite(value);
  fields.flag(flag, given);
  double number = given ? value : 0;
  fields.number(key, number, 0);
  value = given ? number : std::numeric_limits<double>::infinity();
}

template <class Fields>
void walk(Fields& fields, ToolSettings& tool) {
  count(fields, "asset", tool.asset);
  walk(fields, tool.placement);
  fields.number("coupling_n_m", tool.coupling, 0);
  fields.number("turning_n_m_rad", tool.turning, 0);
  limit(fields, "torque_capped", "torque_cap_n_m", tool.torque_cap);
  fields.number("spacing_m", tool.spacing, 0);
  count(fields, "samples", tool.samples);
  fields.number("budget_s", tool.budget, 0);
}

template <class Fields>
void walk(Fields& fields, PlacedObject& object) {
  count(fields, "asset", object.asset);
  fields.word("method", object.force.method, methods);
  fields.word("rule", object.force.rule, paper_rule_words);
  fields.number("stiffness_n_m", object.force.stiffness, 0);
  fields.number("probe_radius_m", object.force.probe_radius, 0);
  // Where they are missing, the recording is older than they are, and its probe is a point or a
  // ball.
  if (fields.has("probe_kind")) {
    fields.word("probe_kind", object.force.probe_kind, probe_kinds);
    fields.word("paper_probe", object.force.form, probe_forms_recorded);
    fields.number("probe_length_m", object.force.probe_length, 0);
    constexpr std::array axis{"probe_axis_x", "probe_axis_y", "probe_axis_z"};
    for (int i = 0; i < 3; ++i) {
      fields.number(axis[static_cast<std::size_t>(i)], object.force.probe_axis[i], -2);
    }
  }
  if (fields.has("density")) fields.number("density", object.force.density, 0);
  fields.flag("movable", object.movable);
  fields.flag("stiffness_chosen", object.stiffness_chosen);
  walk(fields, object.placement);
  walk(fields, object.effects);
}

template <class Settings>
Json json_of(Settings settings) {
  Writer writer;
  walk(writer, settings);
  return writer.json();
}

bool is_unit(const Eigen::Quaterniond& rotation) {
  return std::abs(rotation.squaredNorm() - 1) <= unit_slack;
}

PlacedObject object_of(const Json& json, std::size_t assets, std::string& problem) {
  PlacedObject object;
  Reader reader(json, "object.", problem);
  walk(reader, object);
  if (problem.empty() && (object.asset >= assets || !is_unit(object.placement.rotation))) {
    problem = "an object names an asset that is not listed, or its rotation is none";
  }
  if (problem.empty() && !(std::abs(object.force.probe_axis.squaredNorm() - 1) <= unit_slack)) {
    problem = "the axis of a probe is not of unit length";
  }
  return object;
}

ToolSettings recorded_tool(const Json& json, std::size_t assets, std::string& problem) {
  ToolSettings tool;
  Reader reader(json, "tool.", problem);
  walk(reader, tool);
  if (problem.empty() && (tool.asset >= assets || !is_unit(tool.placement.rotation))) {
    problem = "the tool names an asset that is not listed, or its rotation is none";
  }
  return tool;
}

tl::unexpected<Error> bad(const std::string& problem) {
  return fail(ExitCode::invalid_input, "its scene: " + problem + "; record it again");
}

}  // namespace

void RecordedScene::follow(const SceneStep& step) {
  std::vector<PlacedObject>& objects = scene.objects;
  if (step.kind == RecordedKind::stabilized) scene.stabilization = step.stabilization;
  if (step.kind == RecordedKind::added && step.object == objects.size()) {
    objects.push_back(step.settings);
    gone.push_back(false);
  }
  if (step.object >= objects.size()) return;
  if (step.kind == RecordedKind::placed) {
    objects[step.object].placement.position = step.settings.placement.position;
    objects[step.object].placement.rotation = step.settings.placement.rotation;
  } else if (step.kind == RecordedKind::added || step.kind == RecordedKind::changed) {
    objects[step.object] = step.settings;
    gone[step.object] = false;
  } else if (step.kind == RecordedKind::removed) {
    gone[step.object] = true;
  }
}

std::string text_of(const RecordedScene& recorded) {
  Json objects = Json::array();
  for (std::size_t i = 0; i < recorded.scene.objects.size(); ++i) {
    objects.push_back(json_of(recorded.scene.objects[i]));
    objects.back()["gone"] = i < recorded.gone.size() && recorded.gone[i];
  }
  Json json = {{"workspace", json_of(recorded.scene.workspace)},
               {"stabilization", json_of(recorded.scene.stabilization)},
               {"objects", std::move(objects)}};
  if (recorded.scene.tool) {
    json["tool"] = json_of(*recorded.scene.tool);
    for (const ToolSettings& tool : recorded.scene.more_tools) {
      json["more_tools"].push_back(json_of(tool));
    }
    // By which a coupling that the tool does not name is chosen.
    json["added"] = json_of(recorded.scene.added);
  }
  return json.dump();
}

Result<RecordedScene> recorded_scene(const std::string& text, std::size_t assets) {
  const Json json = parse_json<Json>(text);
  if (!json.is_object() || !json.contains("workspace") || !json.contains("stabilization")) {
    return bad("it does not say what its forces came from");
  }
  RecordedScene recorded;
  std::string problem;
  Reader workspace(json["workspace"], "workspace.", problem);
  walk(workspace, recorded.scene.workspace);
  Reader stabilization(json["stabilization"], "stabilization.", problem);
  walk(stabilization, recorded.scene.stabilization);
  if (json.contains("tool")) {
    recorded.scene.tool = recorded_tool(json["tool"], assets, problem);
    for (const Json& tool : json.value("more_tools", Json::array())) {
      recorded.scene.more_tools.push_back(recorded_tool(tool, assets, problem));
    }
    recorded.scene.added = object_of(json.value("added", Json()), assets, problem);
  }
  JsonFields fields(json, "", problem);
  for (const Json& entry : fields.array("objects")) {
    recorded.scene.objects.push_back(object_of(entry, assets, problem));
    recorded.gone.push_back(JsonFields(entry, "object.", problem).flag("gone"));
    if (!problem.empty()) break;
  }
  if (problem.empty() && !is_unit(recorded.scene.workspace.rotation)) {
    problem = "`workspace` has no rotation";
  }
  if (problem.empty() && recorded.scene.objects.empty()) problem = "it has no objects";
  if (!problem.empty()) return bad(problem);
  return recorded;
}

RecordedChange recorded(const SceneStep& step) {
  RecordedChange change;
  change.tick = step.tick;
  change.kind = step.kind;
  change.object = static_cast<std::uint32_t>(step.object);
  if (step.kind == RecordedKind::placed) {
    const Placement& to = step.settings.placement;
    change.pose = {to.position.x(), to.position.y(), to.position.z(), to.rotation.w(),
                   to.rotation.x(), to.rotation.y(), to.rotation.z()};
  } else if (step.kind == RecordedKind::added || step.kind == RecordedKind::changed) {
    change.settings = json_of(step.settings).dump();
  } else if (step.kind == RecordedKind::stabilized) {
    change.settings = json_of(step.stabilization).dump();
  }
  return change;
}

Result<SceneStep> step_of(const RecordedChange& change, std::size_t assets) {
  SceneStep step{change.tick, change.kind, change.object, {}};
  std::string problem;
  if (change.kind == RecordedKind::placed) {
    const auto& pose = change.pose;
    step.settings.placement.position = {pose[0], pose[1], pose[2]};
    step.settings.placement.rotation = Eigen::Quaterniond(pose[3], pose[4], pose[5], pose[6]);
  } else if (!change.settings.empty()) {
    const Json json = parse_json<Json>(change.settings);
    if (!json.is_object()) return bad("a change is no JSON object");
    if (change.kind == RecordedKind::stabilized) {
      Reader reader(json, "stabilization.", problem);
      walk(reader, step.stabilization);
    } else {
      step.settings = object_of(json, assets, problem);
    }
  }
  if (!problem.empty()) return bad(problem);
  return step;
}

std::vector<RecordedAsset> assets_of(const Recording& recording) {
  std::vector<RecordedAsset> assets = recording.header.assets;
  for (const RecordedChange& change : recording.changes) {
    for (std::size_t i = assets.size(); i < change.assets.size(); ++i) {
      assets.push_back(change.assets[i]);
    }
  }
  return assets;
}

Result<std::vector<SceneStep>> steps_of(const Recording& recording) {
  const std::size_t assets = assets_of(recording).size();
  std::vector<SceneStep> steps;
  for (const RecordedChange& change : recording.changes) {
    auto step = step_of(change, assets);
    if (!step) return tl::make_unexpected(std::move(step.error()));
    steps.push_back(std::move(*step));
  }
  return steps;
}

}  // namespace spm::servo
