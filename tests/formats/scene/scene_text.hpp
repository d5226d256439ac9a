// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>

#include "formats/scene/scene.hpp"
#include "tests/formats/support/synthetic_asset.hpp"

namespace spm::test {

/// Runs read_scene on a file that holds this text, `scene.toml` in a folder of its own.
[[nodiscard]] inline Result<Scene> scene_of_text(const std::string& text) {
  const TemporaryFolder folder;
  write_bytes(folder.path("scene.toml"), text);
  return read_scene(folder.path("scene.toml"));
}

}  // namespace spm::test
