// SPDX-License-Identifier: Apache-2.0
#include "formats/scene.hpp"

#include <toml++/toml.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <filesystem>
#include <initializer_list>

#include "common/units.hpp"
#include "formats/cli/nearest_word.hpp"
#include "formats/text_file.hpp"

namespace spm {
namespace {

constexpr double unit_slack = 1e-3;  // of a quaternion written with few digits

std::string in_quotes(std::string_view text) {
  std::string result(1, '\'');
  result.append(text).push_back('\'');
  return result;
}

/// Reads one table. The first thing that is wrong is kept; what is read after it is a default.
class TableReader {
 public:
  TableReader(const std::string& path, const toml::table& table, std::string name,
              std::initializer_list<const char*> keys, std::optional<Error>& error)
      : path_(path), table_(table), name_(std::move(name)), error_(error) {
    const std::vector<std::string> known(keys.begin(), keys.end());
    for (const auto& [key, value] : table_) {
      if (std::find(known.begin(), known.end(), key.str()) == known.end()) unknown(key, known);
    }
  }

  [[nodiscard]] bool has(const char* key) const { return table_.contains(key); }

  void refuse(const char* key, const std::string& cause) {
    const toml::node* value = table_.get(key);
    refuse_at(value != nullptr ? value->source() : table_.source(), cause);
  }

  /// Text that is not empty.
  [[nodiscard]] std::string text(const char* key, const std::string& example) {
    const toml::node* value = table_.get(key);
    if (value == nullptr) return {};
    const auto* found = value->as_string();
    if (found != nullptr && !found->get().empty()) return found->get();
    refuse(key, in_quotes(key) + " must be text, such as \"" + example + "\"");
    return {};
  }

  [[nodiscard]] double quantity(const char* key, Quantity kind, const std::string& example,
                                double otherwise) {
    const toml::node* value = table_.get(key);
    if (value == nullptr) return otherwise;
    const auto* found = value->as_string();
    if (found == nullptr) {
      refuse(key, in_quotes(key) + " must be text with its unit, such as \"" + example + "\"");
      return otherwise;
    }
    const Result<double> parsed = parse_quantity(found->get(), kind);
    if (!parsed) {
      refuse(key, in_quotes(key) + ": " + parsed.error().message);
      return otherwise;
    }
    if (*parsed > 0) return *parsed;
    refuse(key, in_quotes(key) + " must be above 0, such as \"" + example + "\"");
    return otherwise;
  }

  [[nodiscard]] Placement placement() {
    Placement placement;
    if (has("pose")) read_pose(placement);
    if (has("scale")) {
      const std::optional<double> scale = table_["scale"].value<double>();
      if (table_["scale"].is_number() && scale && std::isfinite(*scale) && *scale > 0) {
        placement.scale = *scale;
      } else {
        refuse("scale", "'scale' must be a number above 0, such as 2.0");
      }
    }
    return placement;
  }

 private:
  const std::string& path_;
  const toml::table& table_;
  std::string name_;
  std::optional<Error>& error_;

  void refuse_at(const toml::source_region& place, const std::string& cause) {
    if (error_) return;
    error_ = Error{ExitCode::invalid_input,
                   path_ + ": line " + std::to_string(place.begin.line) + ": " + cause};
  }

  void unknown(const toml::key& key, const std::vector<std::string>& known) {
    std::string cause = "unknown key " + in_quotes(key.str()) + " in " + name_ + "; ";
    if (const auto near = cli::nearest_word(key.str(), known)) {
      cause += "did you mean " + in_quotes(*near) + "?";
    } else {
      cause += "its keys are";
      for (const std::string& name : known) cause += " " + name;
    }
    refuse_at(key.source(), cause);
  }

  void read_pose(Placement& placement) {
    const char* cure = "; give [x, y, z] in metres, or [x, y, z, qw, qx, qy, qz]";
    const toml::array* array = table_.get("pose")->as_array();
    if (array == nullptr || (array->size() != 3 && array->size() != 7)) {
      return refuse("pose", std::string("'pose' must be three or seven numbers") + cure);
    }
    std::array<double, 7> numbers{0, 0, 0, 1, 0, 0, 0};
    for (std::size_t i = 0; i < array->size(); ++i) {
      const toml::node& value = *array->get(i);
      const std::optional<double> number = value.value<double>();
      if (!value.is_number() || !number || !std::isfinite(*number)) {
        return refuse("pose", std::string("'pose' holds what is no finite number") + cure);
      }
      numbers[i] = *number;
    }
    const Eigen::Quaterniond rotation(numbers[3], numbers[4], numbers[5], numbers[6]);
    if (!(std::abs(rotation.norm() - 1) <= unit_slack)) {
      return refuse("pose",
                    "the quaternion of 'pose' is not of unit length; give qw qx qy qz of "
                    "unit length");
    }
    placement.position = Vector3(numbers[0], numbers[1], numbers[2]);
    placement.rotation = rotation.normalized();
  }
};

/// What a scene's path means: relative to the scene's own folder.
std::string resolved(const std::string& scene, const std::string& path) {
  if (path.empty()) return path;
  return (std::filesystem::path(scene).parent_path() / path).string();
}

SceneDevice read_device(TableReader&& reader) {
  SceneDevice device;
  device.driver = reader.text("driver", "sim");
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

std::optional<double> read_tool(TableReader&& reader) {
  const std::string text = reader.text("probe", "sphere:0.5mm");
  if (text.empty()) return std::nullopt;
  const Result<double> radius = parse_probe(text);
  if (radius) return *radius;
  reader.refuse("probe", "'probe': " + radius.error().message);
  return std::nullopt;
}

SceneObject read_object(TableReader&& reader, const std::string& scene) {
  SceneObject object;
  object.asset = resolved(scene, reader.text("asset", "teeth.spm.exr"));
  object.mesh = resolved(scene, reader.text("mesh", "teeth.obj"));
  object.placement = reader.placement();
  object.stiffness = reader.quantity("stiffness", Quantity::stiffness, "1.5N/mm", object.stiffness);
  object.stiffness_given = reader.has("stiffness");
  if (!reader.has("asset") && !reader.has("mesh")) {
    reader.refuse("asset",
                  "an object needs 'mesh', what it is baked from, or 'asset', its baked "
                  "file, or both");
  }
  return object;
}

/// Reads the tables of a document; `error` gets the first thing that is wrong.
Scene read_document(const std::string& path, const toml::table& document,
                    std::optional<Error>& error) {
  Scene scene;
  scene.path = path;
  TableReader top(path, document, "a scene", {"device", "tool", "workspace", "object"}, error);
  for (const char* name : {"device", "tool", "workspace"}) {
    const toml::node* node = document.get(name);
    if (node == nullptr) continue;
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
      scene.probe_radius = read_tool(TableReader(path, table, in, {"probe"}, error));
    } else {
      scene.workspace = TableReader(path, table, in, {"pose", "scale"}, error).placement();
    }
  }
  const toml::node* objects = document.get("object");
  if (objects == nullptr || !objects->is_array_of_tables()) {
    top.refuse("object", "a scene needs an object; add [[object]] with 'mesh' or 'asset'");
    return scene;
  }
  for (const toml::node& node : *objects->as_array()) {
    TableReader reader(path, *node.as_table(), "[[object]]",
                       {"asset", "mesh", "pose", "scale", "stiffness"}, error);
    scene.objects.push_back(read_object(std::move(reader), path));
    scene.objects.back().line = static_cast<int>(node.source().begin.line);
  }
  return scene;
}

}  // namespace

Result<Scene> read_scene(const std::string& path) {
  const Result<std::string> text = read_text_file(path, "a scene, a TOML file");
  if (!text) return tl::make_unexpected(text.error());
  std::optional<Error> error;
  try {
    const toml::table document = toml::parse(*text, path);
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
