// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <span>
#include <string>
#include <vector>

#include "common/base/placement.hpp"
#include "formats/motion/recording.hpp"
#include "servo/record/recorded_scene.hpp"

namespace spm::servo {

/// Names of the columns, in their order.
[[nodiscard]] std::vector<std::string> column_names();

/// As Playback::rows(). `workspace`: the hand's frame in the world.
[[nodiscard]] std::string columns_of(const Recording& recording, std::size_t device,
                                     const Placement& workspace, std::size_t most);

/// As Playback::steps(). `scene` is that before the first step.
[[nodiscard]] std::string steps_bytes(RecordedScene scene, std::span<const SceneStep> steps,
                                      double rate_hz);

}  // namespace spm::servo
