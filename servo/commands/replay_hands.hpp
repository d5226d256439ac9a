// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <memory>
#include <span>
#include <string>
#include <vector>

#include "servo/commands/replay_source.hpp"
#include "servo/loop/replay.hpp"

namespace spm::servo {

/// One device's ticks, of a trajectory or of a recording.
struct Played {
  std::size_t device = 0;
  ReplayOptions options;
  RecordedTicks ticks;
  std::size_t comparable = 0;  ///< number of the first rows whose forces can be compared
  ReplayResult result;
  ForceDifference found;
};

/// The devices that are replayed for the ones that are asked for: all of them where tools meet.
[[nodiscard]] std::vector<std::size_t> hands_to_play(const ReplaySource& source,
                                                     const std::vector<std::size_t>& devices);

/// The samples of the tools of a scene, by hands, or one for all; none without a tool.
using ReplayTools = std::vector<std::unique_ptr<SampledTool>>;

/// Makes them. Errors: those of SampledTool::make, with the tool's file.
[[nodiscard]] Result<ReplayTools> tools_for(const ReplaySource& source,
                                            std::span<const AssetView* const> views);

/// The ticks of one device, and how they are replayed: as `given`, and as a recording says.
/// `hashes`: of the assets' contents.
[[nodiscard]] Played ticks_to_play(const ReplaySource& source, std::size_t device,
                                   const std::vector<std::string>& hashes,
                                   const ReplayOptions& given);

/// Replays all; hands whose tools meet all at once.
void play_all(const ForceScene& scene, std::span<const AssetView* const> views,
              std::vector<Played>& all);

}  // namespace spm::servo
