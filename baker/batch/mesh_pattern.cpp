// SPDX-License-Identifier: GPL-3.0-or-later
#include "baker/batch/mesh_pattern.hpp"

#include <glob.h>

#include <algorithm>
#include <filesystem>
#include <memory>
#include <system_error>

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

}  // namespace

bool is_mesh_pattern(const std::string& folder, const std::string& path) {
  if (path.find_first_of("*?[") == std::string::npos) return false;
  std::error_code ignored;
  return !std::filesystem::exists(std::filesystem::path(folder) / path, ignored);
}

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

}  // namespace spm::baker
