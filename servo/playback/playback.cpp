// SPDX-License-Identifier: Apache-2.0
#include "servo/playback/playback.hpp"

#include <algorithm>
#include <filesystem>
#include <system_error>
#include <utility>

#include "formats/motion/recording_salvage.hpp"
#include "servo/force/scene_force.hpp"
#include "servo/playback/playback_columns.hpp"
#include "servo/playback/playback_marks.hpp"

namespace spm::servo {

using nlohmann::ordered_json;

namespace {

namespace fs = std::filesystem;

/// Where an asset is now: where it was, or else beside the recording.
fs::path place_of(const std::string& path, const std::string& recording) {
  std::error_code ignored;
  if (fs::exists(path, ignored)) return path;
  const fs::path beside = fs::path(recording).parent_path() / fs::path(path).filename();
  return fs::exists(beside, ignored) ? beside : fs::path(path);
}

PlayedAsset find_asset(const RecordedAsset& recorded, const std::string& recording) {
  PlayedAsset found;
  found.name = fs::path(recorded.path).filename().string();
  auto asset = MappedAsset::open(place_of(recorded.path, recording).string());
  if (!asset) {
    found.problem = asset.error().message;
    return found;
  }
  if (!recorded.content_sha256.empty() && (*asset)->content_sha256() != recorded.content_sha256) {
    found.problem =
        "the file there now is another one than was touched: its surface is drawn, and "
        "may differ";
  }
  found.asset = std::move(*asset);
  return found;
}

ordered_json numbers(const Vector3& vector) { return {vector.x(), vector.y(), vector.z()}; }

ordered_json to_json(const PlacedObject& object, bool gone) {
  constexpr std::array<const char*, 3> methods{"spm", "paper", "proxy"};
  const Eigen::Quaterniond& turn = object.placement.rotation;
  return {{"asset", object.asset},
          {"gone", gone},
          {"position", numbers(object.placement.position)},
          {"orientation", {turn.w(), turn.x(), turn.y(), turn.z()}},
          {"scale", object.placement.scale},
          {"method", methods[static_cast<std::size_t>(object.force.method)]},
          {"stiffness", object.force.stiffness}};
}

ordered_json to_json(const Marks& marks) {
  ordered_json json = {{"list", ordered_json::array()}, {"found", ordered_json::object()}};
  for (const Mark& mark : marks.list) {
    json["list"].push_back({{"kind", to_string(mark.kind)},
                            {"first", mark.first},
                            {"last", mark.last},
                            {"cause", mark.cause}});
  }
  for (std::size_t i = 0; i < mark_kinds; ++i) {
    json["found"][to_string(static_cast<MarkKind>(i))] = marks.found[i];
  }
  return json;
}

}  // namespace

Result<Playback> Playback::open(const std::string& path) {
  Result<SalvagedRecording> salvaged = salvage_recording(path);
  if (!salvaged) return tl::make_unexpected(std::move(salvaged.error()));
  Playback playback;
  playback.recording_ = std::move(salvaged->recording);
  playback.loss_ = std::move(salvaged->loss);
  playback.name_ = fs::path(path).filename().string();
  const Recording& recording = playback.recording_;
  if (recording.rows.empty()) {
    return fail(ExitCode::invalid_input, path + ": has no tick to show; record a longer run");
  }
  const std::vector<RecordedAsset> assets = assets_of(recording);
  auto scene = recorded_scene(recording.header.scene, assets.size());
  auto steps = steps_of(recording);
  for (const Error* problem :
       {scene ? nullptr : &scene.error(), steps ? nullptr : &steps.error()}) {
    if (problem != nullptr) return fail(problem->code, path + ": " + problem->message);
  }
  playback.scene_ = std::move(*scene);
  playback.steps_ = std::move(*steps);
  for (const RecordedAsset& asset : assets) playback.assets_.push_back(find_asset(asset, path));
  return playback;
}

bool Playback::holds_tool(std::size_t device) const noexcept {
  return std::any_of(recording_.rows.begin(), recording_.rows.end(), [&](const RecordingRow& row) {
    return row.device == device && (row.flags & recorded_tool) != 0;
  });
}

ordered_json Playback::summary() const {
  const RecordingHeader& header = recording_.header;
  ordered_json json = {{"name", name_},
                       {"loss", loss_},
                       {"version", header.spm_version},
                       {"rate_hz", header.rate_hz},
                       {"stabilized", scene_.scene.stabilization.any()},
                       {"columns", column_names()}};
  json["devices"] = ordered_json::array();
  for (std::size_t i = 0; i < header.devices.size(); ++i) {
    const ToolSettings* const tool = tool_of(scene_.scene, i);
    json["devices"].push_back(
        {{"name", header.devices[i].name},
         {"tool", tool != nullptr && holds_tool(i) ? ordered_json(tool->asset) : ordered_json()},
         {"rows", std::count_if(recording_.rows.begin(), recording_.rows.end(),
                                [&](const RecordingRow& row) { return row.device == i; })},
         {"marks", to_json(marks_of(recording_, i))}});
  }
  json["objects"] = ordered_json::array();
  for (std::size_t i = 0; i < scene_.scene.objects.size(); ++i) {
    json["objects"].push_back(to_json(scene_.scene.objects[i], scene_.gone[i]));
  }
  json["assets"] = ordered_json::array();
  for (const PlayedAsset& asset : assets_) {
    json["assets"].push_back(
        {{"name", asset.name}, {"problem", asset.problem}, {"drawn", asset.asset != nullptr}});
  }
  json["causes"] = ordered_json::array();
  for (const std::string& name : header.causes) {
    json["causes"].push_back({{"name", name}, {"cure", cure_of_cause(name)}});
  }
  return json;
}

std::string Playback::rows(std::size_t device, std::size_t most) const {
  return columns_of(recording_, device, scene_.scene.workspace, most);
}

std::string Playback::steps() const {
  return steps_bytes(scene_, steps_, recording_.header.rate_hz);
}

}  // namespace spm::servo
