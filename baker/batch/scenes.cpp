// SPDX-License-Identifier: GPL-3.0-or-later
#include "baker/batch/scenes.hpp"

#include <fmt/format.h>
#include <toml++/toml.h>

#include <algorithm>
#include <filesystem>
#include <map>
#include <sstream>
#include <system_error>

#include "baker/build/build.hpp"
#include "common/base/units.hpp"
#include "formats/files/output_file.hpp"
#include "formats/files/text_file.hpp"
#include "formats/scene/scene.hpp"

namespace spm::baker {
namespace {

namespace fs = std::filesystem;

/// The one name of a file, whether it is there or not.
std::string canonical(const std::string& path) {
  std::error_code ignored;
  return fs::weakly_canonical(path, ignored).string();
}

/// An object or a tool of a scene, as far as it matters which file it is.
struct Part {
  std::string asset, mesh;
  int line = 0;
  double scale = 1;
  bool paper = false;  ///< needs an asset of the form full
};

std::vector<Part> parts_of(const Scene& scene) {
  std::vector<Part> parts;
  for (const SceneObject& object : scene.objects) {
    parts.push_back({object.asset, object.mesh, object.line, object.placement.scale,
                     object.method == Method::paper});
  }
  const auto add = [&](const SceneTool& tool) {
    // The scene's probe is nothing to a tool.
    parts.push_back({tool.asset, tool.mesh, tool.line, 0, false});
  };
  if (scene.tool) add(*scene.tool);
  for (const SceneTool& tool : scene.more_tools) add(tool);
  return parts;
}

/// Which assets of a manifest are what a scene names.
class Library {
 public:
  explicit Library(const Manifest& manifest) : manifest_(manifest) {
    for (std::size_t i = 0; i < manifest.entries.size(); ++i) {
      const BuildRequest& request = manifest.entries[i].request;
      outputs_.emplace(canonical(request.output), i);
      meshes_.emplace(canonical(request.mesh), i);
    }
  }

  /// Errors: invalid_input, of a place in the scene.
  [[nodiscard]] Result<ScenePart> find(const Scene& scene, const Part& part) const {
    if (!part.asset.empty()) {
      const auto baked = outputs_.find(canonical(part.asset));
      if (baked != outputs_.end()) return ScenePart{part.asset, baked->second};
      std::error_code ignored;
      if (fs::is_regular_file(part.asset, ignored)) return ScenePart{part.asset, std::nullopt};
      return refuse(
          scene, part,
          fmt::format("'asset': {} is no output of {} and no file; name the 'mesh' alone, "
                      "or the output of its [[asset]]",
                      part.asset, manifest_.path));
    }
    const auto [first, last] = meshes_.equal_range(canonical(part.mesh));
    if (first == last) {
      return refuse(scene, part,
                    fmt::format("'mesh': {} is the mesh of no asset of {}; add an [[asset]] for it",
                                part.mesh, manifest_.path));
    }
    if (std::next(first) != last) {
      return refuse(
          scene, part,
          fmt::format("'mesh': {} is the mesh of several assets of {}, such as {} and {}; "
                      "say which by 'asset'",
                      part.mesh, manifest_.path, output(first->second),
                      output(std::next(first)->second)));
    }
    return ScenePart{output(first->second), first->second};
  }

  [[nodiscard]] static tl::unexpected<Error> refuse(const Scene& scene, const Part& part,
                                                    const std::string& cause) {
    return fail(ExitCode::invalid_input,
                fmt::format("{}: line {}: {}", scene.path, part.line, cause));
  }

 private:
  const Manifest& manifest_;
  // The number of the entry.
  std::map<std::string, std::size_t> outputs_;
  std::multimap<std::string, std::size_t> meshes_;

  [[nodiscard]] const std::string& output(std::size_t entry) const {
    return manifest_.entries[entry].request.output;
  }
};

/// Whether the manifest bakes for the probe and the method of a scene.
Result<void> check_fit(const Scene& scene, const Part& part, const ManifestEntry& entry) {
  const BuildRequest& request = entry.request;
  if (part.paper && request.bake.form != AssetForm::full) {
    return Library::refuse(
        scene, part,
        fmt::format("'method' paper needs an asset of the form full, but {} is "
                    "baked in the form sparse; give its [[asset]] form = \"full\"",
                    entry.name));
  }
  // A scene that the asset is baked for decides otherwise.
  const bool derived = !request.limits.scene.empty() && !request.limits.probe_given;
  if (derived || !scene.probe || !(part.scale > 0)) return {};
  const double radius = scene.probe->radius / part.scale;
  if (radius <= request.bake.probe_radius * (1 + 1e-9)) return {};
  std::string needed = format_quantity(radius, Quantity::length);
  std::erase(needed, ' ');
  return Library::refuse(
      scene, part,
      fmt::format("the probe has a radius of {} for this object, but {} is baked "
                  "for {}; give its [[asset]] probe = \"sphere:{}\"",
                  needed, entry.name, format_quantity(request.bake.probe_radius, Quantity::length),
                  needed));
}

/// Reads a scene and finds the baked file of each of its parts.
Result<void> find_parts_of(const Manifest& manifest, const Library& library, ManifestScene& named) {
  Result<std::string> text = read_text_file(named.scene, "a scene, a TOML file");
  if (!text) return tl::make_unexpected(text.error());
  named.text = std::move(*text);
  const Result<Scene> scene = parse_scene(named.scene, named.text);
  if (!scene) return tl::make_unexpected(scene.error());
  for (const Part& part : parts_of(*scene)) {
    const Result<ScenePart> found = library.find(*scene, part);
    if (!found) return tl::make_unexpected(found.error());
    if (found->entry) {
      Result<void> fit = check_fit(*scene, part, manifest.entries[*found->entry]);
      if (!fit) return fit;
    }
    named.parts.push_back(*found);
  }
  return {};
}

std::string way_between(const std::string& folder, const std::string& file) {
  return fs::path(canonical(file)).lexically_relative(canonical(folder)).string();
}

/// A scene as it reads from another folder, with the baked file of each object and each tool.
std::string rewritten(const ManifestScene& scene) {
  toml::table document = toml::parse(scene.text, scene.scene);  // it was read before
  const fs::path from = fs::path(scene.scene).parent_path();
  const std::string to = (fs::path(".") / fs::path(scene.output).parent_path()).string();
  std::size_t next = 0;
  const auto place = [&](toml::table& table) {
    if (table.get("asset") == nullptr && table.get("mesh") == nullptr) return;  // a probe
    if (const auto mesh = table["mesh"].value<std::string>()) {
      table.insert_or_assign("mesh", way_between(to, (from / *mesh).string()));
    }
    if (next < scene.parts.size()) {
      table.insert_or_assign("asset", way_between(to, scene.parts[next++].asset));
    }
  };
  for (const char* key : {"object", "tool"}) {  // in the order of parts_of
    toml::node* node = document.get(key);
    if (node == nullptr) continue;
    if (toml::table* table = node->as_table()) place(*table);
    if (toml::array* tables = node->as_array()) {
      for (toml::node& table : *tables) place(*table.as_table());
    }
  }
  std::ostringstream written;
  written << "# Written by spm-bake batch from " << way_between(to, scene.scene) << "\n\n"
          << document << '\n';
  return written.str();
}

Result<void> write_where_new(const std::string& path, const std::string& text) {
  std::error_code ignored;
  if (fs::is_regular_file(path, ignored)) {
    const Result<std::string> before = read_text_file(path, "a scene");
    if (before && *before == text) return {};
  }
  make_folder_of(path);
  return write_file(path, text);
}

}  // namespace

Result<void> find_parts(Manifest& manifest) {
  if (manifest.scenes.empty()) return {};
  const Library library(manifest);
  for (ManifestScene& named : manifest.scenes) {
    const Result<void> found = find_parts_of(manifest, library, named);
    if (found) continue;
    return fail(ExitCode::invalid_input, fmt::format("{}: line {}: 'scene': {}", manifest.path,
                                                     named.line, found.error().message));
  }
  return {};
}

nlohmann::ordered_json line_of(const ManifestScene& scene, const SceneOutcome& outcome) {
  nlohmann::ordered_json line;
  line["name"] = scene.name;
  line["ok"] = outcome.ok();
  line["error"] = outcome.ok() ? nlohmann::ordered_json() : nlohmann::ordered_json(outcome.error);
  line["exit_code"] = static_cast<int>(outcome.code);
  line["scene"] = scene.scene;
  line["output"] =
      scene.output.empty() ? nlohmann::ordered_json() : nlohmann::ordered_json(scene.output);
  line["assets"] = outcome.assets;
  return line;
}

std::vector<SceneOutcome> finish_scenes(const Manifest& manifest,
                                        const std::function<bool(const ManifestEntry&)>& done) {
  std::vector<SceneOutcome> outcomes;
  const auto finish = [&](const ManifestScene& named, SceneOutcome& outcome) -> Result<void> {
    for (const ScenePart& part : named.parts) {
      if (part.entry && !done(manifest.entries[*part.entry])) {
        return fail(
            ExitCode::batch_failed,
            fmt::format("{}: not finished, since its asset {} was not baked; bake that first",
                        named.scene, manifest.entries[*part.entry].name));
      }
      const std::string asset = fs::path(part.asset).lexically_normal().string();
      const auto& all = outcome.assets;
      if (std::find(all.begin(), all.end(), asset) == all.end()) outcome.assets.push_back(asset);
    }
    if (named.output.empty()) return {};
    return write_where_new(named.output, rewritten(named));
  };
  for (const ManifestScene& scene : manifest.scenes) {
    SceneOutcome& outcome = outcomes.emplace_back();
    if (const Result<void> finished = finish(scene, outcome); !finished) {
      outcome.code = finished.error().code;
      outcome.error = finished.error().message;
    }
  }
  return outcomes;
}

}  // namespace spm::baker
