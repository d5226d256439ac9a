// SPDX-License-Identifier: Apache-2.0
#include "formats/scene/scene.hpp"

#include <toml++/toml.h>

#include <array>
#include <filesystem>

#include "common/base/units.hpp"
#include "common/contact/stable_stiffness.hpp"
#include "formats/files/text_file.hpp"
#include "formats/scene/scene_effects.hpp"
#include "formats/scene/scene_placement.hpp"
#include "formats/scene/scene_stabilization.hpp"
#include "formats/scene/scene_tool.hpp"
#include "formats/scene/table_reader.hpp"

namespace spm {
namespace {

constexpr double max_density = 1000;  // nothing is so many times denser than another

/// Resolves a path in a scene: relative to the scene's own folder.
std::string resolved(const std::string& scene, const std::string& path) {
  if (path.empty()) return path;
  return (std::filesystem::path(scene).parent_path() / path).string();
}

SceneDevice read_device(TableReader&& reader) {
  SceneDevice device;
  device.driver = reader.text("driver", "sim");
  device.driver_line = reader.line("driver");
  const std::string name = reader.text("profile", "falcon");
  if (!name.empty()) {
    device.profile = find_device_profile(name);
    if (device.profile == nullptr) {
      reader.refuse("profile", "profile " + in_quotes(name) + " is not known; the profiles are" +
                                   device_profile_names());
    }
  }
  if (reader.has("force_cap")) {
    device.force_cap = reader.quantity("force_cap", Quantity::force, "3N", 0);
    if (device.profile != nullptr && *device.force_cap > device.profile->force_cap) {
      reader.refuse("force_cap", "'force_cap' is more than a " + name +
                                     " is made for; give at most " +
                                     format_quantity(device.profile->force_cap, Quantity::force));
    }
  }
  return device;
}

/// `chosen`: the value of "auto", N/m in the scene's world; nothing where no device is named. It is
/// also taken where nothing is given.
void read_stiffness(TableReader& reader, std::optional<double> chosen, SceneObject& object) {
  object.stiffness_given = reader.has("stiffness");
  const toml::node* value = reader.node("stiffness");
  object.stiffness_chosen = value != nullptr && value->value<std::string_view>() == "auto";
  if (!object.stiffness_given) {
    object.stiffness = chosen.value_or(object.stiffness);
  } else if (!object.stiffness_chosen) {
    object.stiffness =
        reader.quantity("stiffness", Quantity::stiffness, "1.5N/mm", object.stiffness);
  } else if (chosen) {
    object.stiffness = *chosen;
  } else {
    reader.refuse(
        "stiffness",
        "'stiffness' \"auto\" is chosen by the device; add 'profile' to [device], one of" +
            device_profile_names());
  }
}

SceneObject read_object(TableReader&& reader, const Scene& scene) {
  SceneObject object;
  object.asset = resolved(scene.path, reader.text("asset", "teeth.spm.exr"));
  object.mesh = resolved(scene.path, reader.text("mesh", "teeth.obj"));
  object.placement = read_placement(reader);
  constexpr std::array methods{Method::spm, Method::proxy, Method::paper};
  if (const auto word = reader.word("method", {"spm", "proxy", "paper"})) {
    object.method = methods[*word];
  }
  if (const auto word = reader.word("paper_rule", std::span(paper_rule_words))) {
    object.rule = static_cast<PaperRule>(*word);
  }
  object.density = reader.number("density", 0, max_density, object.density);
  std::optional<double> chosen;
  if (scene.device.profile != nullptr) {
    chosen = stable_stiffness(*scene.device.profile) / scene.workspace.scale;
  }
  read_stiffness(reader, chosen, object);
  object.effects = read_effects(reader, object.stiffness);
  object.movable = reader.flag("movable", object.movable);
  if (const auto word =
          reader.word("open", {open_as_words[0], open_as_words[1], open_as_words[2]})) {
    object.open = static_cast<OpenAs>(*word);
  }
  if (!reader.has("asset") && !reader.has("mesh")) {
    reader.refuse("asset",
                  "an object needs 'mesh', what it is baked from, or 'asset', its baked "
                  "file, or both");
  }
  return object;
}

std::optional<SceneTool> resolved(const std::string& scene, std::optional<SceneTool> tool) {
  if (!tool) return tool;
  tool->asset = resolved(scene, tool->asset);
  tool->mesh = resolved(scene, tool->mesh);
  return tool;
}

/// The tools of the devices, one for each in their order.
void read_tools(const toml::array& tables, Scene& scene, std::optional<Error>& error) {
  for (const toml::node& node : tables) {
    TableReader reader(scene.path, *node.as_table(), "[[tool]]", tool_keys, error);
    for (const char* key : {"probe", "paper_probe"}) {
      if (!reader.has(key)) continue;
      reader.refuse(key, in_quotes(key) +
                             " is of [tool], which all devices share; a [[tool]] is an object of "
                             "one device: give its 'asset', or write [tool]");
    }
    std::optional<SceneTool> tool = resolved(scene.path, read_tool(reader));
    if (!tool) {
      reader.refuse("asset",
                    "a [[tool]] is an object that one device holds; give 'asset', its baked file");
      return;
    }
    if (scene.tool) {
      scene.more_tools.push_back(*tool);
    } else {
      scene.tool = tool;
    }
  }
}

/// Refuses what only a point or a ball in a hand could have: the tool is an object.
void refuse_beside_tool(TableReader& stabilization, const Scene& scene) {
  if (!scene.tool) return;
  const auto refuse = [&](const char* key, double value) {
    if (!(value > 0)) return;
    stabilization.refuse(key, in_quotes(key) +
                                  " of [stabilization] is for a point or a ball, and the tool is "
                                  "an object; leave it out, or give 'damping' and 'passivity'");
  };
  refuse("coupling", scene.stabilization.coupling);
  refuse("potential", scene.stabilization.potential);
}

/// Reads the tables of a document; `error` gets the first error.
Scene read_document(const std::string& path, const toml::table& document,
                    std::optional<Error>& error) {
  Scene scene;
  scene.path = path;
  TableReader top(path, document, "a scene",
                  {"device", "tool", "workspace", "stabilization", "object"}, error);
  for (const char* name : {"device", "tool", "workspace", "stabilization"}) {
    const toml::node* node = document.get(name);
    if (node == nullptr) continue;
    if (name == std::string_view("tool") && node->is_array_of_tables()) {
      read_tools(*node->as_array(), scene, error);
      continue;
    }
    if (!node->is_table()) {
      top.refuse(name, in_quotes(name) + " must be a table; write [" + name + "]");
      continue;
    }
    const toml::table& table = *node->as_table();
    const std::string in = std::string("[") + name + "]";
    if (name == std::string_view("device")) {
      scene.device =
          read_device(TableReader(path, table, in, {"driver", "profile", "force_cap"}, error));
    } else if (name == std::string_view("tool")) {
      TableReader reader(path, table, in, tool_keys, error);
      scene.probe = read_probe(reader);
      scene.probe_form = read_probe_form(reader);
      scene.tool = resolved(path, read_tool(reader));
    } else if (name == std::string_view("stabilization")) {
      TableReader reader(path, table, in, stabilization_keys, error);
      scene.stabilization_given = true;
      scene.delay_given = reader.has("delay");
      scene.stabilization = read_stabilization(reader, scene.device.profile);
      refuse_beside_tool(reader, scene);
    } else {
      TableReader reader(path, table, in, {"pose", "scale"}, error);
      scene.workspace = read_placement(reader);
    }
  }
  const toml::node* objects = document.get("object");
  if (objects == nullptr || !objects->is_array_of_tables()) {
    top.refuse("object", "a scene needs an object; add [[object]] with 'mesh' or 'asset'");
    return scene;
  }
  for (const toml::node& node : *objects->as_array()) {
    TableReader reader(
        path, *node.as_table(), "[[object]]",
        {"asset", "mesh", "pose", "scale", "stiffness", "method", "paper_rule", "density",
         "friction", "damping", "texture", "smoothing", "turn_limit", "movable", "open"},
        error);
    scene.objects.push_back(read_object(std::move(reader), scene));
    scene.objects.back().line = static_cast<int>(node.source().begin.line);
  }
  return scene;
}

}  // namespace

Result<Scene> read_scene(const std::string& path) {
  const Result<std::string> text = read_text_file(path, "a scene, a TOML file");
  if (!text) return tl::make_unexpected(text.error());
  return parse_scene(path, *text);
}

Result<Scene> parse_scene(const std::string& path, const std::string& text) {
  std::optional<Error> error;
  try {
    const toml::table document = toml::parse(text, path);
    Scene scene = read_document(path, document, error);
    if (!error) return scene;
  } catch (const toml::parse_error& problem) {
    return fail(ExitCode::invalid_input, path + ": line " +
                                             std::to_string(problem.source().begin.line) +
                                             ": not TOML: " + std::string(problem.description()));
  }
  return tl::make_unexpected(*error);
}

}  // namespace spm
