// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <functional>
#include <nlohmann/json.hpp>
#include <string>
#include <vector>

#include "baker/batch/manifest.hpp"

namespace spm::baker {

/// Reads every scene of a manifest, once, and finds the baked files of its parts: each object and
/// each tool must be an asset of the manifest, by its `asset` or else by its `mesh`, or a baked
/// file that is there; and what the manifest bakes for it must be of the form and for the probe
/// that the scene needs. Errors: invalid_input, with the place in the scene and the line in the
/// manifest.
[[nodiscard]] Result<void> find_parts(Manifest& manifest);

/// What became of a scene.
struct SceneOutcome {
  ExitCode code = ExitCode::done;
  std::string error;
  std::vector<std::string> assets;  ///< baked files that it needs, each once

  [[nodiscard]] bool ok() const { return code == ExitCode::done; }
};

/// The scene's line of `batch --json`.
[[nodiscard]] nlohmann::ordered_json line_of(const ManifestScene& scene,
                                             const SceneOutcome& outcome);

/// Writes the scenes that have an `output`, once their assets are there: `done` tells of an asset
/// of the manifest whether it was baked. A written scene names each baked file and mesh by its way
/// from the scene's own folder. One that has the right bytes already is not touched. A scene
/// that was edited since the manifest was read is written as it was then. Gives one outcome a
/// scene.
[[nodiscard]] std::vector<SceneOutcome> finish_scenes(
    const Manifest& manifest, const std::function<bool(const ManifestEntry&)>& done);

}  // namespace spm::baker
