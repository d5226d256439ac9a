// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <map>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "common/base/error.hpp"
#include "servo/playback/playback.hpp"
#include "servo/view/view_pages.hpp"

namespace spm::servo {

/// How many recordings a page shows beside each other.
inline constexpr std::size_t most_recordings = 2;

/// The recordings that a page plays, as files that it asks for: `recordings.json`; and of recording
/// I `recording/I/steps`, `recording/I/rows/DEVICE` and `recording/I/mesh/ASSET`. Made when they
/// are asked for, meshes once.
class ViewRecordings {
 public:
  /// Errors: those of Playback::open().
  [[nodiscard]] static Result<ViewRecordings> open(const std::vector<std::string>& paths);

  /// Nothing where there is no such file.
  [[nodiscard]] std::optional<PageFile> file(const std::string& path);

 private:
  [[nodiscard]] std::optional<std::string> bytes(const std::string& path);
  [[nodiscard]] std::optional<std::string> mesh(std::size_t recording, std::size_t asset);

  std::vector<Playback> recordings_;
  std::map<std::pair<std::size_t, std::size_t>, std::string> meshes_;
};

}  // namespace spm::servo
