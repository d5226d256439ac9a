// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <span>
#include <string>
#include <vector>

#include "servo/commands/replay_hands.hpp"
#include "servo/commands/replay_source.hpp"

namespace spm::servo {

/// A replay as a recording, so that two methods on one path can be looked at and compared: the
/// poses that were replayed, with the forces that the replay gave them as those that were wanted
/// and, where the force was on, sent. There was no safety stage. Of a trajectory it has one device,
/// `trajectory`. `hashes`: of the assets' contents.
[[nodiscard]] Recording replayed_recording(const ReplaySource& source,
                                           std::span<const std::string> hashes,
                                           const std::vector<Played>& all);

/// Writes a recording. Errors: file_or_device.
[[nodiscard]] Result<void> write_whole(const std::string& path, const Recording& recording);

}  // namespace spm::servo
