// SPDX-License-Identifier: GPL-3.0-or-later
#include "baker/batch/depfile.hpp"

#include <algorithm>
#include <filesystem>
#include <set>
#include <system_error>

#include "baker/mesh/mesh_files.hpp"
#include "formats/files/output_file.hpp"
#include "formats/files/text_file.hpp"

namespace spm::baker {
namespace {

/// A path as a rule of make spells it; ninja reads the same.
std::string escaped(const std::string& path) {
  std::string text;
  for (const char letter : path) {
    if (letter == ' ' || letter == '#' || letter == ':') text += '\\';
    if (letter == '$') text += '$';
    text += letter;
  }
  return text;
}

std::string folder_of(const std::string& path) {
  const std::string folder = std::filesystem::path(path).parent_path().lexically_normal().string();
  return folder.empty() ? "." : folder;
}

}  // namespace

Dependencies dependencies_of(const BuildRequest& request) {
  Dependencies found{request.output, {request.mesh}};
  for (std::string& companion : mesh_companions(request.mesh, request.load.outside_buffers)) {
    found.inputs.push_back(std::move(companion));
  }
  if (!request.limits.scene.empty()) found.inputs.push_back(request.limits.scene);
  return found;
}

std::vector<Dependencies> dependencies_of(const Manifest& manifest) {
  // An output changes its folder, and would be out of date as soon as it is written.
  std::set<std::string> written;
  for (const ManifestEntry& entry : manifest.entries) {
    written.insert(folder_of(entry.request.output));
  }
  for (const ManifestScene& scene : manifest.scenes) {
    if (!scene.output.empty()) written.insert(folder_of(scene.output));
  }
  std::vector<std::string> common{manifest.path};
  for (const std::string& folder : manifest.searched_folders) {
    const std::string normal = std::filesystem::path(folder).lexically_normal().string();
    if (written.count(normal) == 0) common.push_back(folder);
  }
  for (const ManifestScene& scene : manifest.scenes) {
    if (scene.output.empty()) common.push_back(scene.scene);
  }
  std::vector<Dependencies> all;
  for (const ManifestScene& scene : manifest.scenes) {
    if (scene.output.empty()) continue;
    all.push_back({scene.output, {scene.scene}});
    all.back().inputs.insert(all.back().inputs.end(), common.begin(), common.end());
  }
  for (const ManifestEntry& entry : manifest.entries) {
    all.push_back(dependencies_of(entry.request));
    all.back().inputs.insert(all.back().inputs.end(), common.begin(), common.end());
  }
  return all;
}

std::string depfile_text(const std::vector<Dependencies>& dependencies) {
  std::string text;
  std::set<std::string> inputs, outputs;
  for (const Dependencies& one : dependencies) {
    text += escaped(one.output) + ":";
    for (const std::string& input : one.inputs) text += " \\\n  " + escaped(input);
    text += '\n';
    inputs.insert(one.inputs.begin(), one.inputs.end());
    outputs.insert(one.output);
  }
  for (const std::string& input : inputs) {
    if (outputs.count(input) == 0) text += escaped(input) + ":\n";
  }
  return text;
}

Result<void> write_depfile(const std::string& path, const std::vector<Dependencies>& dependencies) {
  const std::string text = depfile_text(dependencies);
  std::error_code ignored;
  if (std::filesystem::is_regular_file(path, ignored)) {
    if (const Result<std::string> before = read_text_file(path, "a dep-file");
        before && *before == text) {
      return {};
    }
  }
  return write_file(path, text);
}

}  // namespace spm::baker
