// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <vector>

#include "formats/motion/recording.hpp"
#include "servo/devices/base/device.hpp"
#include "servo/loop/loop_settings.hpp"
#include "servo/scene/scene_assets.hpp"

namespace spm::servo {

/// The assets that are served now, by number, as a recording names them.
[[nodiscard]] std::vector<RecordedAsset> recorded_assets(const SceneAssets& assets);

/// The header of a recording of a run, but for its scene: all that its forces come from beside it.
[[nodiscard]] RecordingHeader recording_header(const LoopSettings& settings,
                                               const ForceChoice& choice, const SceneAssets& assets,
                                               const std::vector<Device*>& devices);

}  // namespace spm::servo
