// SPDX-License-Identifier: GPL-3.0-or-later
#include "baker/commands/manifest.hpp"

#include <fmt/format.h>
#include <toml++/toml.h>

#include <algorithm>
#include <filesystem>
#include <map>
#include <memory>

#include "formats/files/nearest_word.hpp"
#include "formats/files/text_file.hpp"

namespace spm::baker {
namespace {

Error invalid(const std::string& path, const toml::source_region& place, const std::string& cause) {
  return {ExitCode::invalid_input, fmt::format("{}: line {}: {}", path, place.begin.line, cause)};
}

/// Keys of an entry: `name`, `mesh`, `output` and the long names of build's options.
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

/// A value as the command line would spell it. Empty for a type that no option takes.
std::optional<std::string> spelt(const toml::node& value) {
  if (const auto* text = value.as_string()) return text->get();
  if (const auto* whole = value.as_integer()) return fmt::format("{}", whole->get());
  if (const auto* real = value.as_floating_point()) return fmt::format("{}", real->get());
  if (const auto* flag = value.as_boolean()) return flag->get() ? "true" : "false";
  return std::nullopt;
}

std::string resolved(const std::filesystem::path& folder, const std::string& path) {
  return (folder / path).string();
}

/// Parses one entry through build's own option table.
Result<ManifestEntry> read_entry(const std::string& path, const toml::table& table,
                                 const std::vector<std::string>& keys) {
  ManifestEntry entry;
  CLI::App options;
  add_build_options(options, entry.request);
  std::vector<std::string> arguments;
  std::map<std::string, toml::source_region> places;
  const std::filesystem::path folder = std::filesystem::path(path).parent_path();
  for (const auto& [key, value] : table) {
    const std::string name(key.str());
    places["--" + name] = key.source();
    if (std::find(keys.begin(), keys.end(), name) == keys.end()) {
      const auto near = cli::nearest_word(name, keys);
      return tl::make_unexpected(invalid(
          path, key.source(),
          fmt::format("unknown key '{}'{}", name,
                      near
                          ? fmt::format("; did you mean '{}'?", *near)
                          : std::string("; the keys are mesh, output, name and build's options"))));
    }
    const std::optional<std::string> text = spelt(value);
    if (!text) {
      return tl::make_unexpected(
          invalid(path, key.source(), fmt::format("'{}' must be a string or a number", name)));
    }
    if (name == "name") {
      entry.name = *text;
    } else if (name == "mesh") {
      arguments.push_back(resolved(folder, *text));
    } else if (name == "output") {
      arguments.push_back("--output=" + resolved(folder, *text));
    } else if (name == "scene") {
      arguments.push_back("--scene=" + resolved(folder, *text));
    } else {
      arguments.push_back("--" + name + "=" + *text);
    }
  }
  // CLI11 takes arguments from the back; the positional comes last so that no option eats it.
  std::stable_partition(arguments.begin(), arguments.end(),
                        [](const std::string& argument) { return !argument.starts_with("--"); });
  try {
    options.parse(arguments);
  } catch (const CLI::RequiredError&) {
    return tl::make_unexpected(
        invalid(path, table.source(), "an asset needs both keys, 'mesh' and 'output'"));
  } catch (const CLI::ParseError& problem) {
    const std::string cause = problem.what();
    const auto place = places.find(cause.substr(0, cause.find(':')));
    return tl::make_unexpected(
        invalid(path, place != places.end() ? place->second : table.source(), cause));
  }
  if (entry.name.empty()) {
    const std::string file = std::filesystem::path(entry.request.output).filename().string();
    entry.name = file.substr(0, file.find('.', 1));
  }
  return entry;
}

}  // namespace

Result<std::vector<ManifestEntry>> read_manifest(const std::string& path) {
  const Result<std::string> text = read_text_file(path, "a manifest file");
  if (!text) return tl::make_unexpected(text.error());
  toml::table document;
  try {
    document = toml::parse(*text, path);
  } catch (const toml::parse_error& problem) {
    return tl::make_unexpected(
        invalid(path, problem.source(), fmt::format("not TOML: {}", problem.description())));
  }
  const std::vector<std::string> keys = known_keys();
  std::vector<ManifestEntry> entries;
  for (const auto& [key, value] : document) {
    if (key != "asset" || !value.is_array_of_tables()) {
      return tl::make_unexpected(invalid(
          path, key.source(),
          fmt::format("unknown key '{}'; a manifest holds [[asset]] tables only", key.str())));
    }
    for (const toml::node& node : *value.as_array()) {
      Result<ManifestEntry> entry = read_entry(path, *node.as_table(), keys);
      if (!entry) return tl::make_unexpected(entry.error());
      const bool taken =
          std::any_of(entries.begin(), entries.end(), [&](const ManifestEntry& other) {
            return other.request.output == entry->request.output;
          });
      if (taken) {
        return tl::make_unexpected(
            invalid(path, node.source(),
                    fmt::format("the output {} is an earlier asset's too; give each its own",
                                entry->request.output)));
      }
      entries.push_back(std::move(*entry));
    }
  }
  if (entries.empty()) {
    return fail(ExitCode::invalid_input,
                path + ": line 1: no asset; add [[asset]] tables with mesh and output");
  }
  return entries;
}

}  // namespace spm::baker
