// SPDX-License-Identifier: Apache-2.0

// What scripts/charts/plot_tool.py draws: the samples of a scene's tool, level by level, and where
// the tool touches at the most places. Prints a JSON object; lengths in the tool's
// frame, as the hand holds it.
// Usage: show_tool SCENE.toml RECORDING

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <memory>
#include <nlohmann/json.hpp>
#include <span>
#include <string>
#include <vector>

#include "formats/asset/mapped_asset.hpp"
#include "formats/motion/recording.hpp"
#include "formats/motion/trajectory.hpp"
#include "servo/commands/replay_source.hpp"
#include "servo/force/default_settings.hpp"
#include "servo/force/sampled_tool.hpp"
#include "servo/force/scene_force.hpp"
#include "servo/loop/replay.hpp"
#include "servo/scene/force_choice.hpp"
#include "servo/scene/tool_choice.hpp"

namespace {

using namespace spm;
using namespace spm::servo;
using Json = nlohmann::ordered_json;

constexpr std::size_t most_shown = 6000;  // samples of a level

/// mm, to a hundredth: no picture shows more.
Json rounded_mm(const Vector3& place) {
  Json row = Json::array();
  for (const double x : place) row.push_back(std::round(1e5 * x) / 100);
  return row;
}

Json levels_of(const SurfaceSamples& samples) {
  Json levels = Json::array();
  for (const SampleLevel& level : samples.levels) {
    Json places = Json::array();
    const std::size_t step = (level.count + most_shown - 1) / most_shown;
    for (std::size_t i = 0; i < level.count; i += step) {
      const auto& place = samples.places[level.first + i].position;
      places.push_back(rounded_mm(Vector3(place[0], place[1], place[2])));
    }
    levels.push_back(
        {{"samples", level.count}, {"spacing_mm", 1e3 * level.spacing}, {"places_mm", places}});
  }
  return levels;
}

/// `placement`: of the asset in the hand.
Json patches_of(const ToolTick& tick, const Placement& placement) {
  Eigen::Isometry3d seat = Eigen::Isometry3d::Identity();
  seat.translation() = placement.position;
  seat.linear() = placement.rotation.toRotationMatrix();
  const Eigen::Isometry3d to_tool = seat * tick.pose.inverse(Eigen::Isometry);
  Json patches = Json::array();
  for (const ContactPatch& patch : tick.contacts()) {
    const Vector3 push = to_tool.linear() * patch.force;
    patches.push_back({{"place_mm", rounded_mm(to_tool * patch.place)},
                       {"force_n", {push.x(), push.y(), push.z()}},
                       {"depth_um", 1e6 * patch.depth}});
  }
  return patches;
}

/// What is needed of a scene, opened.
struct Opened {
  ForceChoice choice;
  std::vector<std::unique_ptr<MappedAsset>> assets;
  std::vector<const AssetView*> views;
  std::unique_ptr<SampledTool> tool;
};

Result<Opened> open(const std::string& scene, const RecordedDevice& device) {
  ForceOptions options;
  options.scene = scene;
  options.device = recorded_device(device);
  auto choice = choose_forces(options);
  if (!choice) return tl::make_unexpected(std::move(choice.error()));
  Opened opened;
  opened.choice = std::move(*choice);
  if (!opened.choice.scene.tool) {
    return fail(ExitCode::invalid_input, scene + ": names no [tool] asset to show; give one");
  }
  for (std::size_t i = 0; i < opened.choice.assets.size(); ++i) {
    auto asset = MappedAsset::open(opened.choice.assets[i]);
    if (!asset) return tl::make_unexpected(std::move(asset.error()));
    opened.views.push_back(&(*asset)->view());
    opened.assets.push_back(std::move(*asset));
  }
  const ToolSettings& settings = *opened.choice.scene.tool;
  auto tool = SampledTool::make(*opened.views[settings.asset], settings, 1,
                                opened.choice.scene.objects.size());
  if (!tool) return tl::make_unexpected(std::move(tool.error()));
  opened.tool = std::move(*tool);
  return opened;
}

/// Plays so many ticks; `at` becomes the tick with the most patches, and of these the one of the
/// largest force.
Json played(Opened& opened, const RecordingHeader& header, std::span<const TrajectorySample> way,
            std::size_t& at) {
  const RecordedDevice& device = header.devices.front();
  const double period = 1 / header.rate_hz;
  SceneForce force(opened.choice.scene, period, device.encoder_step, 0,
                   felt_limits(recorded_device(device), period), recorded_turning(device));
  force.take_tool(opened.tool.get(), 0);
  ContactForce felt;
  double most = -1;
  std::size_t places = 0;
  for (std::size_t i = 0; i < way.size(); ++i) {
    felt = force.next(opened.views, way[i].pose());
    const std::size_t patches = force.tool().patch_count;
    if (patches < places || (patches == places && !(felt.force.norm() > most))) continue;
    places = patches;
    most = felt.force.norm();
    at = i;
  }
  return {{"force_n", felt.force.norm()},
          {"torque_n_m", felt.torque.norm()},
          {"patches", patches_of(force.tool(), opened.choice.scene.tool->placement)}};
}

int failed(const Error& error) {
  static_cast<void>(std::fprintf(stderr, "%s\n", error.message.c_str()));
  return static_cast<int>(error.code);
}

}  // namespace

int main(int count, char** words) {
  if (count != 3) {
    return failed({ExitCode::usage, "usage: show_tool SCENE.toml RECORDING"});
  }
  const auto recording = read_recording(words[2]);
  if (!recording) return failed(recording.error());
  const std::vector<TrajectorySample> way = ticks_of(*recording, 0).trajectory;
  auto opened = open(words[1], recording->header.devices.front());
  if (!opened) return failed(opened.error());
  std::size_t at = 0;
  static_cast<void>(played(*opened, recording->header, way, at));
  const Json contact = played(*opened, recording->header, std::span(way).first(at + 1), at);
  const Json shown = {
      {"tick", at}, {"levels", levels_of(opened->tool->samples())}, {"contact", contact}};
  static_cast<void>(std::printf("%s\n", shown.dump().c_str()));
  return 0;
}
