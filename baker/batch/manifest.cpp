// SPDX-License-Identifier: GPL-3.0-or-later
#include "baker/batch/manifest.hpp"

#include <fmt/format.h>
#include <glob.h>
#include <toml++/toml.h>

#include <algorithm>
#include <filesystem>
#include <map>
#include <memory>
#include <set>
#include <system_error>
#include <unordered_map>

#include "baker/batch/scenes.hpp"
#include "baker/build/build.hpp"
#include "formats/files/nearest_word.hpp"
#include "formats/files/sha256.hpp"
#include "formats/files/text_file.hpp"

namespace spm::baker {
namespace {

/// A folder's name in which no character has a meaning of its own.
std::string escaped(const std::string& folder) {
  std::string text;
  for (const char letter : folder) {
    if (std::string_view("*?[]\\").find(letter) != std::string_view::npos) text += '\\';
    text += letter;
  }
  return text;
}

/// True where a path has characters of a pattern (`*`, `?` or `[`) and no file has it for a name.
bool is_mesh_pattern(const std::string& folder, const std::string& path) {
  if (path.find_first_of("*?[") == std::string::npos) return false;
  std::error_code ignored;
  return !std::filesystem::exists(std::filesystem::path(folder) / path, ignored);
}

/// The files that match a pattern, relative to a folder whose own name is taken as it is; in the
/// order of their bytes, whatever the locale.
std::vector<std::string> find_meshes(const std::string& folder, const std::string& pattern) {
  const std::string whole = (std::filesystem::path(escaped(folder)) / pattern).string();
  glob_t raw{};
  const int code = ::glob(whole.c_str(), GLOB_NOSORT | GLOB_MARK, nullptr, &raw);
  const std::unique_ptr<glob_t, void (*)(glob_t*)> found(&raw, &::globfree);
  std::vector<std::string> meshes;
  if (code != 0) return meshes;
  for (std::size_t i = 0; i < raw.gl_pathc; ++i) {
    std::string path = raw.gl_pathv[i];
    if (!path.ends_with('/')) meshes.push_back(std::move(path));
  }
  std::sort(meshes.begin(), meshes.end());
  return meshes;
}

/// A text with `{stem}` and `{folder}` filled in from the path of a mesh. Errors: invalid_input for
/// any other word in braces.
Result<std::string> filled_in(const std::string& text, const std::string& mesh) {
  const std::filesystem::path path = std::filesystem::path(mesh).lexically_normal();
  std::string filled;
  for (std::size_t at = 0; at < text.size();) {
    const std::size_t open = text.find('{', at);
    filled += text.substr(at, open - at);
    if (open == std::string::npos) break;
    const std::size_t close = text.find('}', open);
    const std::string word =
        text.substr(open, close == std::string::npos ? std::string::npos : close + 1 - open);
    if (word == "{stem}") {
      filled += path.stem().string();
    } else if (word == "{folder}") {
      filled += path.parent_path().filename().string();
    } else {
      return fail(ExitCode::invalid_input,
                  "'" + word + "' stands for nothing; {stem} and {folder} of the mesh do");
    }
    at = close + 1;
  }
  return filled;
}

/// A value as the command line would spell it, and where its key stands.
struct Setting {
  std::string text;
  std::uint32_t line = 0;
};

using Settings = std::map<std::string, Setting>;

Error invalid(const std::string& path, std::uint32_t line, const std::string& cause) {
  return {ExitCode::invalid_input, fmt::format("{}: line {}: {}", path, line, cause)};
}

/// Keys of an asset: `name`, `mesh`, `output` and the long names of build's options.
std::vector<std::string> known_keys() {
  CLI::App table;
  BuildRequest request;
  add_build_options(table, request);
  std::vector<std::string> keys{"name", "mesh"};
  for (const CLI::Option* option : table.get_options()) {
    for (const std::string& name : option->get_lnames()) {
      if (name != "help") keys.push_back(name);
    }
  }
  return keys;
}

/// Empty for a type that no option takes.
std::optional<std::string> spelt(const toml::node& value) {
  if (const auto* text = value.as_string()) return text->get();
  if (const auto* whole = value.as_integer()) return fmt::format("{}", whole->get());
  if (const auto* real = value.as_floating_point()) return fmt::format("{}", real->get());
  if (const auto* flag = value.as_boolean()) return flag->get() ? "true" : "false";
  return std::nullopt;
}

std::string resolved(const std::string& folder, const std::string& path) {
  return (std::filesystem::path(folder) / path).string();
}

class Reader {
 public:
  explicit Reader(const std::string& path)
      : path_(path), folder_(std::filesystem::path(path).parent_path().string()) {}

  Result<Manifest> read() {
    const Result<std::string> text = read_text_file(path_, "a manifest file");
    if (!text) return tl::make_unexpected(text.error());
    toml::table document;
    try {
      document = toml::parse(*text, path_);
    } catch (const toml::parse_error& problem) {
      return tl::make_unexpected(invalid(path_, problem.source().begin.line,
                                         fmt::format("not TOML: {}", problem.description())));
    }
    manifest_.path = path_;
    manifest_.sha256 = sha256_bytes(*text);
    const Result<void> added = read_document(document);
    if (!added) return tl::make_unexpected(added.error());
    if (const Result<void> fit = find_parts(manifest_); !fit) {
      return tl::make_unexpected(fit.error());
    }
    std::sort(manifest_.searched_folders.begin(), manifest_.searched_folders.end());
    manifest_.searched_folders.erase(
        std::unique(manifest_.searched_folders.begin(), manifest_.searched_folders.end()),
        manifest_.searched_folders.end());
    return std::move(manifest_);
  }

 private:
  [[nodiscard]] tl::unexpected<Error> refuse(std::uint32_t line, const std::string& cause) const {
    return tl::make_unexpected(invalid(path_, line, cause));
  }

  Result<void> read_document(const toml::table& document) {
    for (const auto& [key, value] : document) {
      const bool listed = (key == "asset" || key == "scene") && value.is_array_of_tables();
      if (!listed && !(key == "defaults" && value.is_table())) {
        return refuse(key.source().begin.line,
                      fmt::format("unknown key '{}'; a manifest holds [[asset]] and [[scene]] "
                                  "tables and one table [defaults] only",
                                  key.str()));
      }
    }
    Settings defaults;
    if (const toml::table* table = document["defaults"].as_table()) {
      const Result<Settings> read = read_settings(*table, keys_);
      if (!read) return tl::make_unexpected(read.error());
      defaults = *read;
      for (const char* own : {"mesh", "name"}) {
        if (const auto found = defaults.find(own); found != defaults.end()) {
          return refuse(found->second.line,
                        fmt::format("'{}' is an asset's own and has no default; move it into "
                                    "[[asset]]",
                                    own));
        }
      }
    }
    const toml::array* tables = document["asset"].as_array();
    if (tables == nullptr || tables->empty()) {
      return refuse(1, "no asset; add [[asset]] tables with mesh and output");
    }
    if (Result<void> read = read_assets(*tables, defaults); !read) return read;
    if (const toml::array* scenes = document["scene"].as_array()) return read_scenes(*scenes);
    return {};
  }

  Result<void> read_scenes(const toml::array& tables) {
    for (const toml::node& node : tables) {
      const Result<Settings> read = read_settings(*node.as_table(), scene_keys_);
      if (!read) return tl::make_unexpected(read.error());
      const auto scene = read->find("scene");
      if (scene == read->end()) {
        return refuse(node.source().begin.line,
                      "'scene' is missing: a [[scene]] names the file of a scene, or a pattern");
      }
      if (!is_mesh_pattern(folder_, scene->second.text)) {
        if (Result<void> added = add_scene(*read, resolved(folder_, scene->second.text)); !added) {
          return added;
        }
        continue;
      }
      const std::vector<std::string> found = find_meshes(folder_, scene->second.text);
      if (found.empty()) {
        return refuse(scene->second.line,
                      fmt::format("'scene': no file matches {}; check the pattern",
                                  resolved(folder_, scene->second.text)));
      }
      for (const std::string& path : found) {
        search(path);
        if (Result<void> added = add_scene(*read, path); !added) return added;
      }
    }
    return {};
  }

  Result<void> add_scene(const Settings& settings, const std::string& file) {
    ManifestScene scene;
    scene.scene = file;
    scene.line = settings.at("scene").line;
    scene.name = std::filesystem::path(file).stem().string();
    if (const auto name = settings.find("name"); name != settings.end()) {
      const Result<std::string> filled = filled_in(name->second.text, file);
      if (!filled) return refuse(name->second.line, "'name': " + filled.error().message);
      scene.name = *filled;
    }
    if (const auto output = settings.find("output"); output != settings.end()) {
      scene.output_line = output->second.line;
      const Result<std::string> filled = filled_in(output->second.text, file);
      if (!filled) return refuse(scene.output_line, "'output': " + filled.error().message);
      scene.output = resolved(folder_, *filled);
      if (normal(scene.output) == normal(file)) {
        return refuse(scene.output_line,
                      "'output' is the scene itself; write elsewhere, or leave "
                      "it out to check the scene where it is");
      }
      if (Result<void> own = take_output(scene.output, scene.output_line); !own) return own;
      if (const Result<void> writable = check_new_output(scene.output); !writable) {
        return refuse(scene.output_line, "'output': " + writable.error().message);
      }
    }
    manifest_.scenes.push_back(std::move(scene));
    return {};
  }

  void search(const std::string& found) {
    const std::string folder = std::filesystem::path(found).parent_path().string();
    manifest_.searched_folders.push_back(folder.empty() ? "." : folder);
  }

  /// Each file is written by one asset or one scene.
  Result<void> take_output(const std::string& output, std::uint32_t line) {
    std::error_code ignored;
    const auto target = std::filesystem::weakly_canonical(output, ignored);
    const auto [taken, first] = outputs_.emplace(target.string(), line);
    if (first) return {};
    return refuse(line, fmt::format("'output': {} is that of another table too, of line {}; give "
                                    "each its own, by {{stem}} where there is a pattern",
                                    output, taken->second));
  }

  Result<void> read_assets(const toml::array& tables, const Settings& defaults) {
    std::vector<std::pair<std::uint32_t, Settings>> assets;
    for (const toml::node& node : tables) {
      Result<Settings> own = read_settings(*node.as_table(), keys_);
      if (!own) return tl::make_unexpected(own.error());
      if (const auto mesh = own->find("mesh");
          mesh != own->end() && !is_mesh_pattern(folder_, mesh->second.text)) {
        named_meshes_.insert(normal(resolved(folder_, mesh->second.text)));
      }
      own->insert(defaults.begin(), defaults.end());  // leaves what the asset says itself
      assets.emplace_back(node.source().begin.line, std::move(*own));
    }
    for (const auto& [line, settings] : assets) {
      if (Result<void> added = add_asset(line, settings); !added) return added;
    }
    return {};
  }

  Result<Settings> read_settings(const toml::table& table,
                                 const std::vector<std::string>& keys) const {
    Settings settings;
    for (const auto& [key, value] : table) {
      const std::string name(key.str());
      const std::uint32_t line = key.source().begin.line;
      if (std::find(keys.begin(), keys.end(), name) == keys.end()) {
        const auto near = cli::nearest_word(name, keys);
        return refuse(line,
                      fmt::format("unknown key '{}'{}", name,
                                  near ? fmt::format("; did you mean '{}'?", *near)
                                  : &keys == &scene_keys_
                                      ? std::string("; the keys are scene, output and name")
                                      : std::string("; the keys are mesh, output, name and build's "
                                                    "options")));
      }
      const std::optional<std::string> text = spelt(value);
      if (!text) return refuse(line, fmt::format("'{}' must be a string or a number", name));
      settings[name] = {*text, line};
    }
    return settings;
  }

  /// What the options of a table ask for, through build's own option table.
  Result<BuildRequest> parse_options(std::uint32_t line, const Settings& settings) const {
    BuildRequest request;
    CLI::App options;
    add_build_options(options, request);
    std::vector<std::string> arguments{"mesh", "--output=asset"};
    for (const auto& [name, setting] : settings) {
      if (name == "name" || name == "mesh" || name == "output") continue;
      arguments.push_back("--" + name + "=" +
                          (name == "scene" ? resolved(folder_, setting.text) : setting.text));
    }
    try {
      options.parse(arguments);
    } catch (const CLI::ParseError& problem) {
      const std::string cause = problem.what();
      const std::string option = cause.substr(0, cause.find(':'));
      const auto place =
          option.starts_with("--") ? settings.find(option.substr(2)) : settings.end();
      return refuse(place != settings.end() ? place->second.line : line, cause);
    }
    return request;
  }

  Result<void> add_asset(std::uint32_t line, const Settings& settings) {
    for (const char* needed : {"mesh", "output"}) {
      if (settings.count(needed) == 0) {
        return refuse(line, fmt::format("'{}' is missing: an asset needs both keys, 'mesh' and "
                                        "'output'",
                                        needed));
      }
    }
    const Result<BuildRequest> request = parse_options(line, settings);
    if (!request) return tl::make_unexpected(request.error());
    const Setting& mesh = settings.at("mesh");
    if (!is_mesh_pattern(folder_, mesh.text)) {
      return add_entry(settings, *request, resolved(folder_, mesh.text));
    }
    std::size_t found = 0;
    for (const std::string& path : find_meshes(folder_, mesh.text)) {
      ++found;
      search(path);
      if (named_meshes_.count(normal(path)) > 0) continue;
      if (Result<void> added = add_entry(settings, *request, path); !added) return added;
    }
    if (found > 0) return {};
    return refuse(mesh.line, fmt::format("'mesh': no file matches {}; check the pattern",
                                         resolved(folder_, mesh.text)));
  }

  Result<void> add_entry(const Settings& settings, const BuildRequest& options,
                         const std::string& mesh) {
    const Setting& output = settings.at("output");
    const Result<std::string> file = filled_in(output.text, mesh);
    if (!file) return refuse(output.line, "'output': " + file.error().message);
    ManifestEntry entry;
    entry.request = options;
    entry.request.mesh = mesh;
    entry.request.output = resolved(folder_, *file);
    entry.output = normal(*file);
    entry.mesh_line = settings.at("mesh").line;
    entry.output_line = output.line;
    if (const auto name = settings.find("name"); name != settings.end()) {
      const Result<std::string> filled = filled_in(name->second.text, mesh);
      if (!filled) return refuse(name->second.line, "'name': " + filled.error().message);
      entry.name = *filled;
    }
    if (entry.name.empty()) {
      const std::string last = std::filesystem::path(entry.output).filename().string();
      entry.name = last.substr(0, last.find('.', 1));
    }
    if (Result<void> own = take_output(entry.request.output, output.line); !own) return own;
    manifest_.entries.push_back(std::move(entry));
    return {};
  }

  [[nodiscard]] static std::string normal(const std::string& path) {
    return std::filesystem::path(path).lexically_normal().string();
  }

  std::string path_;
  std::string folder_;
  std::vector<std::string> keys_ = known_keys();
  std::vector<std::string> scene_keys_{"scene", "output", "name"};
  std::set<std::string> named_meshes_;  // on their own, so patterns leave them out
  std::unordered_map<std::string, std::uint32_t> outputs_;  // and the line of each
  Manifest manifest_;
};

}  // namespace

Result<Manifest> read_manifest(const std::string& path) { return Reader(path).read(); }

}  // namespace spm::baker
