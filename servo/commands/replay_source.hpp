// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <optional>
#include <span>
#include <string>
#include <vector>

#include "formats/motion/recording.hpp"
#include "formats/motion/trajectory.hpp"
#include "servo/loop/replay.hpp"
#include "servo/record/recorded_scene.hpp"
#include "servo/scene/force_choice.hpp"

namespace spm::servo {

/// What is replayed, and with which forces: positions, by the command line; or a recording, by what
/// its own forces came from, unless the command line says otherwise.
struct ReplaySource {
  ForceChoice choice;
  std::vector<TrajectorySample> trajectory;  ///< empty for a recording
  std::optional<Recording> recording;
  RecordedScene recorded;  ///< of the recording, at its first row
  bool own_scene = false;  ///< the recording's scene and its changes are replayed
  std::vector<SceneStep> steps;
};

/// Reads a trajectory or a recording, and decides what forces come from. Errors: those of
/// read_trajectory, read_recording and choose_forces; file_or_device, if an asset of the recording
/// is neither where it was nor beside the recording.
[[nodiscard]] Result<ReplaySource> read_replay_source(const std::string& path,
                                                      const ForceOptions& options);

/// A device of a recording as far as settings depend on it.
[[nodiscard]] ForceDevice recorded_device(const RecordedDevice& device);

/// Its turning, as the forces on a tool depended on it.
[[nodiscard]] HandTurning recorded_turning(const RecordedDevice& device);

/// That of a trajectory: of the scene's device, as if it turned; without one every turn is read,
/// and the torque is limited by the scene's tool alone.
[[nodiscard]] HandTurning trajectory_turning(const ForceChoice& choice);

/// In what the replay differs from the recording's own forces: settings and assets by their names,
/// and the program. `content_sha256`: of the assets that were opened.
[[nodiscard]] std::vector<std::string> replay_differences(
    const ReplaySource& source, std::span<const std::string> content_sha256);

/// The first tick from which on the recording does not say what its forces came from, or from which
/// on they came from other assets than were opened. Nothing if there is none.
[[nodiscard]] std::optional<std::uint64_t> unknown_from(
    const ReplaySource& source, std::span<const std::string> content_sha256);

}  // namespace spm::servo
