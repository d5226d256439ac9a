// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>
#include <vector>

#include "common/base/error.hpp"
#include "formats/motion/recording.hpp"
#include "servo/force/scene_force.hpp"
#include "servo/record/scene_step.hpp"

namespace spm::servo {

/// What forces come from, as a recording has it: a scene, and which of its objects are gone.
/// Numbers come back bit by bit.
struct RecordedScene {
  ForceScene scene;
  std::vector<bool> gone;  ///< of the objects, which keep their numbers

  /// Follows a change, so that this is the scene after it.
  void follow(const SceneStep& step);
};

/// As a recording's header has it, JSON.
[[nodiscard]] std::string text_of(const RecordedScene& scene);

/// Reads it back. `assets`: the number of assets that objects may name. Errors: invalid_input, with
/// a clause that says what is wrong.
[[nodiscard]] Result<RecordedScene> recorded_scene(const std::string& text, std::size_t assets);

/// A change in the form of files, and back. Errors: as above.
[[nodiscard]] RecordedChange recorded(const SceneStep& step);
[[nodiscard]] Result<SceneStep> step_of(const RecordedChange& change, std::size_t assets);

/// All of a recording's changes. A list of assets that grew later counts from the beginning.
/// Errors: as above.
[[nodiscard]] Result<std::vector<SceneStep>> steps_of(const Recording& recording);

/// The assets that a recording's objects name: the first that it says of each.
[[nodiscard]] std::vector<RecordedAsset> assets_of(const Recording& recording);

}  // namespace spm::servo
