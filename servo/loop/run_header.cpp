// SPDX-License-Identifier: Apache-2.0
#include "servo/loop/run_header.hpp"

#include <algorithm>
#include <filesystem>
#include <system_error>

#include "common/base/instruction_set.hpp"
#include "servo/loop/channel.hpp"

namespace spm::servo {

std::vector<RecordedAsset> recorded_assets(const SceneAssets& assets) {
  std::vector<RecordedAsset> list;
  const std::vector<std::string> paths = assets.paths();
  std::error_code ignored;
  for (const KeeperReport& asset : assets.reports()) {
    if (list.size() == paths.size()) break;
    const std::string& path = paths[list.size()];
    const std::filesystem::path whole = std::filesystem::absolute(path, ignored);
    list.push_back({whole.empty() ? path : whole.string(), asset.content_sha256});
  }
  return list;
}

RecordingHeader recording_header(const LoopSettings& settings, const ForceChoice& choice,
                                 const SceneAssets& assets, const std::vector<Device*>& devices) {
  RecordingHeader header;
  header.spm_version = SPM_VERSION;
  header.instruction_set = instruction_set();
  header.rate_hz = settings.rate_hz;
  for (const Device* device : devices) {
    const DeviceCapabilities& can = device->capabilities();
    const double cap = std::min(can.force_cap, settings.force_cap);
    RecordedDevice& recorded = header.devices.emplace_back();
    recorded = {can.name, can.encoder_step, can.stiffness_cap, cap, {}};
    if (can.profile != nullptr) recorded.profile = can.profile->name;
    const HandTurning turning = turning_in_run(can, settings, header.devices.size() - 1);
    recorded.turns = turning.reads;
    recorded.torque_cap = turning.torque_cap;
    recorded.turn_step = turning.turn_step;
    recorded.turning_inertia = turning.inertia;
  }
  for (std::size_t i = 0; i < force_off_count; ++i) {
    header.causes.emplace_back(to_string(static_cast<ForceOff>(i)));
  }
  header.assets = recorded_assets(assets);
  header.scene_path = choice.scene_path;
  return header;
}

}  // namespace spm::servo
