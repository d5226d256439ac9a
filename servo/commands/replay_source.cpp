// SPDX-License-Identifier: Apache-2.0
#include "servo/commands/replay_source.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <filesystem>
#include <limits>
#include <system_error>
#include <utility>

#include "common/base/instruction_set.hpp"
#include "servo/scene/scene_difference.hpp"

namespace spm::servo {

namespace {

/// How much of a sha256 is told.
constexpr std::size_t told_digits = 12;

/// What the command line says instead of the recording.
void settle(PlacedObject& object, const ForceOptions& options) {
  object.force.method = options.method.value_or(object.force.method);
  object.force.rule = options.rule.value_or(object.force.rule);
  object.force.stiffness = options.stiffness.value_or(object.force.stiffness);
  object.stiffness_chosen = object.stiffness_chosen && !options.stiffness;
  object.force.form = options.probe_form.value_or(object.force.form);
  if (options.probe) object.force.take_probe(*options.probe);
}

/// Where an asset is now: where it was, or else beside the recording.
std::string found_asset(const std::string& path, const std::string& recording) {
  std::error_code ignored;
  if (std::filesystem::exists(path, ignored)) return path;
  const auto beside =
      std::filesystem::path(recording).parent_path() / std::filesystem::path(path).filename();
  return std::filesystem::exists(beside, ignored) ? beside.string() : path;
}

/// The recording's own forces.
Result<void> take_own(ReplaySource& source, const std::string& path, const ForceOptions& options) {
  const Recording& recording = *source.recording;
  if (options.stiffness_chosen) {
    return fail(ExitCode::usage,
                "--stiffness auto is chosen by a device; a recording has its "
                "stiffness, leave the option out or give a number");
  }
  ForceChoice& choice = source.choice;
  choice.scene_path = recording.header.scene_path;
  choice.scene = source.recorded.scene;
  for (const RecordedAsset& asset : assets_of(recording)) {
    choice.assets.push_back(found_asset(asset.path, path));
  }
  for (PlacedObject& object : choice.scene.objects) {
    settle(object, options);
    choice.places.push_back(path + ": ");
    if (auto good = check_settings(object.force, object.effects); !good) return good;
  }
  for (SceneStep& step : source.steps) settle(step.settings, options);
  StabilizationSettings& stabilization = choice.scene.stabilization;
  if (options.stabilization) stabilization = in_loop_of(stabilization, *options.stabilization);
  choice.probe = choice.scene.objects.front().force.probe();
  return {};
}

std::string names_of_difference(const ForceScene& then, const ForceScene& now) {
  if (then.objects.size() != now.objects.size()) {
    return fmt::format("{} objects, where the recording has {}", now.objects.size(),
                       then.objects.size());
  }
  for (std::size_t i = 0; i < then.objects.size(); ++i) {
    const std::uint32_t aspects = aspects_of(then.objects[i], now.objects[i]) & felt_aspects;
    if (aspects != 0) return fmt::format("object {}: {}", i, names_of_aspects(aspects));
  }
  return {};
}

bool same_place(const Placement& a, const Placement& b) {
  return a.position == b.position && a.rotation.coeffs() == b.rotation.coeffs() &&
         a.scale == b.scale;
}

}  // namespace

ForceDevice recorded_device(const RecordedDevice& device) {
  return {find_device_profile(device.profile), device.stiffness_cap};
}

HandTurning recorded_turning(const RecordedDevice& device) {
  HandTurning turning;
  turning.reads = device.turns;
  turning.torque_cap = device.torque_cap;
  turning.turn_step = device.turn_step;
  turning.inertia = device.turning_inertia;
  if (device.force_cap > 0) turning.force_cap = device.force_cap;
  return turning;
}

HandTurning trajectory_turning(const ForceChoice& choice) {
  HandTurning turning;
  turning.reads = true;
  turning.torque_cap = std::numeric_limits<double>::infinity();
  if (const DeviceProfile* const profile = choice.device.profile) {
    turning.torque_cap = profile->torque_cap();
    turning.turn_step = profile->turn_step();
    turning.inertia = profile->turning_inertia();
    turning.force_cap = profile->force_cap;
  }
  if (choice.scene.tool)
    turning.torque_cap = std::min(turning.torque_cap, choice.scene.tool->torque_cap);
  return turning;
}

Result<ReplaySource> read_replay_source(const std::string& path, const ForceOptions& asked) {
  ReplaySource source;
  ForceOptions options = asked;
  const bool named = !options.asset.empty() || !options.scene.empty();
  if (is_recording(path)) {
    auto recording = read_recording(path);
    if (!recording) return tl::make_unexpected(std::move(recording.error()));
    auto scene = recorded_scene(recording->header.scene, assets_of(*recording).size());
    auto steps = steps_of(*recording);
    for (const Error* problem :
         {scene ? nullptr : &scene.error(), steps ? nullptr : &steps.error()}) {
      if (problem != nullptr) return fail(problem->code, path + ": " + problem->message);
    }
    source.recording = std::move(*recording);
    source.recorded = std::move(*scene);
    source.steps = std::move(*steps);
    source.own_scene = !named;
    std::vector<ForceDevice> devices;
    for (const RecordedDevice& device : source.recording->header.devices) {
      devices.push_back(recorded_device(device));
    }
    options.device = least_stiff(devices);
    if (source.own_scene) {
      if (auto taken = take_own(source, path, options); !taken) {
        return tl::make_unexpected(std::move(taken.error()));
      }
      return source;
    }
  }
  auto choice = choose_forces(options);
  if (!choice) return tl::make_unexpected(std::move(choice.error()));
  source.choice = std::move(*choice);
  if (source.recording) return source;
  auto trajectory = read_trajectory(path);
  if (!trajectory) return tl::make_unexpected(std::move(trajectory.error()));
  source.trajectory = std::move(*trajectory);
  return source;
}

std::vector<std::string> replay_differences(const ReplaySource& source,
                                            std::span<const std::string> content_sha256) {
  std::vector<std::string> list;
  const ForceScene& then = source.recorded.scene;
  const ForceScene& now = source.choice.scene;
  // A scene of the command line is compared with the recording's beginning.
  const std::vector<RecordedAsset> assets =
      source.own_scene ? assets_of(*source.recording) : source.recording->header.assets;
  for (std::size_t i = 0; i < std::min(assets.size(), content_sha256.size()); ++i) {
    if (assets[i].content_sha256 == content_sha256[i]) continue;
    list.push_back(fmt::format("asset {} is another file ({}, sha256 {}..., then {}...)", i,
                               source.choice.assets[i], content_sha256[i].substr(0, told_digits),
                               assets[i].content_sha256.substr(0, told_digits)));
  }
  if (assets.size() != content_sha256.size()) {
    list.push_back(
        fmt::format("{} assets, where the recording has {}", content_sha256.size(), assets.size()));
  }
  if (std::string objects = names_of_difference(then, now); !objects.empty()) {
    list.push_back(std::move(objects));
  }
  if (then.stabilization != now.stabilization) list.emplace_back("stabilization");
  if (!same_place(then.workspace, now.workspace)) list.emplace_back("workspace");
  // Which asset it is, its number says, and the asset is compared by itself.
  if (then.tool != now.tool || then.more_tools != now.more_tools) list.emplace_back("tool");
  const RecordingHeader& header = source.recording->header;
  if (header.instruction_set != instruction_set() || header.spm_version != SPM_VERSION) {
    list.push_back(fmt::format("the recording was made by version {} with {}, this is {} with {}",
                               header.spm_version, header.instruction_set, SPM_VERSION,
                               instruction_set()));
  }
  return list;
}

std::optional<std::uint64_t> unknown_from(const ReplaySource& source,
                                          std::span<const std::string> content_sha256) {
  if (!source.own_scene) return std::nullopt;
  for (const RecordedChange& change : source.recording->changes) {
    if (change.kind == RecordedKind::lost) return change.tick;
    for (std::size_t i = 0; i < std::min(change.assets.size(), content_sha256.size()); ++i) {
      if (change.assets[i].content_sha256 != content_sha256[i]) return change.tick;
    }
  }
  return std::nullopt;
}

}  // namespace spm::servo
