// SPDX-License-Identifier: Apache-2.0
#include "servo/commands/replay_hands.hpp"

#include <algorithm>
#include <utility>

#include "servo/scene/tool_choice.hpp"

namespace spm::servo {

std::vector<std::size_t> hands_to_play(const ReplaySource& source,
                                       const std::vector<std::size_t>& devices) {
  if (!source.recording || !tools_meet(source.choice.scene)) return devices;
  std::vector<std::size_t> all;
  for (std::size_t i = 0; i < source.recording->header.devices.size(); ++i) all.push_back(i);
  return all;
}

Played ticks_to_play(const ReplaySource& source, std::size_t device,
                     const std::vector<std::string>& hashes, const ReplayOptions& given) {
  Played played;
  played.device = device;
  ReplayOptions& options = played.options = given;
  if (!source.recording) {
    played.ticks.trajectory = source.trajectory;
    return played;
  }
  played.ticks = ticks_of(*source.recording, device);
  const RecordedTicks& ticks = played.ticks;
  const RecordingHeader& header = source.recording->header;
  options.rate_hz = header.rate_hz;
  options.encoder_step = header.devices[device].encoder_step;
  options.limits = felt_limits(recorded_device(header.devices[device]), 1 / header.rate_hz);
  options.turning = recorded_turning(header.devices[device]);
  options.hand = device;
  options.marks = ticks.marks;
  played.comparable = source.own_scene ? ticks.ticks.size() : ticks.comparable;
  if (!source.own_scene) return played;
  options.gone = source.recorded.gone;
  options.steps = steps_before(source.steps, ticks.ticks);
  if (const auto unknown = unknown_from(source, hashes)) {
    const auto at = std::lower_bound(ticks.ticks.begin(), ticks.ticks.end(), *unknown);
    played.comparable = static_cast<std::size_t>(at - ticks.ticks.begin());
  }
  return played;
}

Result<ReplayTools> tools_for(const ReplaySource& source, std::span<const AssetView* const> views) {
  const ForceScene& scene = source.choice.scene;
  const std::size_t hands = source.recording ? source.recording->header.devices.size() : 1;
  const auto added =
      std::count_if(source.steps.begin(), source.steps.end(),
                    [](const SceneStep& step) { return step.kind == RecordedKind::added; });
  const ToolRoom room{hands, objects_to_meet(scene, static_cast<std::size_t>(added))};
  ReplayTools tools(tools_of(scene));
  for (std::size_t i = 0; i < source.choice.assets.size(); ++i) {
    if (!is_tool(scene, i)) continue;
    auto made = sample_tools(*views[i], i, scene, room);
    if (!made) {
      return fail(made.error().code,
                  source.choice.assets[i] + ": can be no tool: " + made.error().message);
    }
    for (std::size_t k = 0; k < tools.size(); ++k) {
      if ((*made)[k]) tools[k] = std::move((*made)[k]);
    }
  }
  return tools;
}

void play_all(const ForceScene& scene, std::span<const AssetView* const> views,
              std::vector<Played>& all) {
  if (!tools_meet(scene) || all.size() == 1) {
    for (Played& one : all) one.result = replay(views, one.ticks.trajectory, one.options);
    return;
  }
  std::vector<ReplayHand> hands;
  for (const Played& one : all) {
    hands.push_back({one.ticks.trajectory, one.ticks.ticks, &one.options});
  }
  std::vector<ReplayResult> results = replay_together(views, hands);
  for (std::size_t i = 0; i < all.size(); ++i) all[i].result = std::move(results[i]);
}

}  // namespace spm::servo
