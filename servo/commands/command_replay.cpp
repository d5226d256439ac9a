// SPDX-License-Identifier: Apache-2.0
#include <fmt/format.h>
#include <spdlog/spdlog.h>

#include <cmath>
#include <memory>
#include <optional>
#include <span>

#include "common/base/instruction_set.hpp"
#include "formats/asset/asset_writer.hpp"
#include "formats/asset/mapped_asset.hpp"
#include "formats/motion/recording.hpp"
#include "servo/commands/commands.hpp"
#include "servo/loop/replay.hpp"
#include "servo/loop/run_report.hpp"
#include "servo/scene/force_choice.hpp"

namespace spm::servo {

namespace {

using nlohmann::ordered_json;

struct ReplayCommand {
  cli::GlobalOptions global;
  std::string trajectory, out;
  double device = 0;  ///< index of the recording's device
  ForceOptions force;
  ReplayOptions options;
};

/// What is replayed: positions, or a device's ticks of a recording.
struct Source {
  RecordedTicks ticks;
  std::optional<RecordingHeader> recording;
};

using Assets = std::vector<std::unique_ptr<MappedAsset>>;

ordered_json asset_json(const std::string& path, const MappedAsset& asset) {
  return {{"path", path},
          {"form", to_string(asset.metadata().form)},
          {"planes", asset.view().planes.size()},
          {"bytes", asset.bytes().total},
          {"content_sha256", asset.content_sha256()}};
}

Result<Source> read_source(const ReplayCommand& command) {
  Source source;
  if (!is_recording(command.trajectory)) {
    auto trajectory = read_trajectory(command.trajectory);
    if (!trajectory) return tl::make_unexpected(std::move(trajectory.error()));
    source.ticks.trajectory = std::move(*trajectory);
    return source;
  }
  auto recording = read_recording(command.trajectory);
  if (!recording) return tl::make_unexpected(std::move(recording.error()));
  const std::size_t devices = recording->header.devices.size();
  if (command.device != std::floor(command.device) ||
      command.device >= static_cast<double>(devices)) {
    return fail(ExitCode::usage,
                fmt::format("--device-number {}: {} is of {} device{}, counted "
                            "from 0",
                            command.device, command.trajectory, devices, devices == 1 ? "" : "s"));
  }
  source.ticks = ticks_of(*recording, static_cast<std::size_t>(command.device));
  source.recording = std::move(recording->header);
  return source;
}

/// The forces equal those of the recording only if asset and program are the ones that made it.
void warn_of_changes(const RecordingHeader& header, const Assets& assets) {
  bool same = header.assets.size() == assets.size();
  for (std::size_t i = 0; same && i < assets.size(); ++i) {
    same = header.assets[i] == assets[i]->content_sha256();
  }
  if (!same) spdlog::warn("the recording was made with other assets; its forces were others");
  if (header.instruction_set != instruction_set() || header.spm_version != SPM_VERSION) {
    spdlog::warn("the recording was made by version {} with {}, this is {} with {}",
                 header.spm_version, header.instruction_set, SPM_VERSION, instruction_set());
  }
}

/// Forces that came from another scene than the replayed one cannot be compared.
void warn_of_scene(const Source& source) {
  const RecordedTicks& ticks = source.ticks;
  if (source.recording->form < 2) {
    spdlog::warn(
        "the recording is of a form that does not mark changes of the scene: if an application "
        "moved objects, or the scene was edited, its forces were others");
  }
  if (ticks.change == SceneChange::none) return;
  spdlog::warn(
      "from tick {} of the recording on {}: forces there are of another scene than the "
      "one that is replayed, and {} compared",
      ticks.changed_tick,
      ticks.change == SceneChange::edit ? "an edited scene was served"
                                        : "objects were moved, added or changed by an application",
      ticks.comparable == 0 ? "none is"
                            : fmt::format("only the {} ticks before it are", ticks.comparable));
}

ordered_json recording_json(const Source& source, const ReplayResult& result) {
  const RecordedTicks& ticks = source.ticks;
  const ForceDifference found = difference(result, std::span(ticks.wanted).first(ticks.comparable));
  ordered_json json = {{"spm_version", source.recording->spm_version},
                       {"instruction_set", source.recording->instruction_set},
                       {"lost", ticks.lost},
                       {"compared_ticks", ticks.comparable},
                       {"scene_changed", nullptr},
                       {"forces_equal", found.ticks == 0},
                       {"differing_ticks", found.ticks},
                       {"largest_difference_n", found.largest}};
  if (found.ticks > 0) json["first_difference_row"] = found.first_row;
  if (ticks.change != SceneChange::none) {
    json["scene_changed"] = {{"tick", ticks.changed_tick},
                             {"row", ticks.comparable},
                             {"by", ticks.change == SceneChange::edit ? "edit" : "application"}};
    if (ticks.comparable == 0) json["forces_equal"] = nullptr;
  }
  return json;
}

/// How the forces compare with the recorded ones, as one line.
std::string comparison_text(const ordered_json& recording) {
  const auto differing = recording["differing_ticks"].get<std::uint64_t>();
  const auto compared = recording["compared_ticks"].get<std::uint64_t>();
  if (recording["forces_equal"].is_null()) {
    return "none of the recording's forces is of the scene that was replayed\n";
  }
  if (differing > 0) {
    return fmt::format("{} forces differ from the recording's, by {:.3g} N at most\n", differing,
                       recording["largest_difference_n"].get<double>());
  }
  if (recording["scene_changed"].is_null()) {
    return "all forces equal those of the recording, bit by bit\n";
  }
  return fmt::format("the first {} forces equal those of the recording, bit by bit\n", compared);
}

ordered_json report_of(const ReplayCommand& command, const ForceChoice& choice,
                       const Assets& assets, const ReplayOptions& options, const Source& source,
                       const ReplayResult& result) {
  const Summary us = us_per_tick(result);
  ordered_json times = {{"mean", us.mean}, {"sd", us.sd}};
  times.update(percentiles_json(us));
  ordered_json report = {{"ticks", result.contacts.size()},
                         {"contact_ticks", contact_ticks(result)}};
  add_forces(report, choice);
  report["us_per_tick"] = std::move(times);
  report["force_step_n"] = percentiles_json(force_steps(result));
  if (source.recording) report["recording"] = recording_json(source, result);
  report["rate_hz"] = options.rate_hz;
  report["pace"] = options.pace == Pace::realtime ? "realtime" : "none";
  if (choice.scene_path.empty()) {
    report["asset"] = asset_json(choice.assets.front(), *assets.front());
  } else {
    report["assets"] = ordered_json::array();
    for (std::size_t i = 0; i < assets.size(); ++i) {
      report["assets"].push_back(asset_json(choice.assets[i], *assets[i]));
    }
  }
  report["out"] = command.out;
  return report;
}

Result<Assets> open_assets(const ForceChoice& choice) {
  MapOptions map;
  map.prefault = true;
  map.lock = true;
  Assets assets;
  for (std::size_t i = 0; i < choice.assets.size(); ++i) {
    auto asset = MappedAsset::open(choice.assets[i], map);
    if (!asset) return tl::make_unexpected(std::move(asset.error()));
    if (auto checked = check_asset((*asset)->metadata(), choice, i); !checked) {
      return tl::make_unexpected(std::move(checked.error()));
    }
    assets.push_back(std::move(*asset));
  }
  return assets;
}

Result<ordered_json> replay_file(const ReplayCommand& command) {
  const auto choice = choose_forces(command.force);
  if (!choice) return tl::make_unexpected(choice.error());
  if (auto checked = check_output_path(command.out); !checked) {
    return tl::make_unexpected(std::move(checked.error()));
  }
  const auto source = read_source(command);
  if (!source) return tl::make_unexpected(source.error());
  const std::vector<TrajectorySample>& trajectory = source->ticks.trajectory;
  const auto assets = open_assets(*choice);
  if (!assets) return tl::make_unexpected(assets.error());
  std::vector<const AssetView*> views;
  for (const auto& asset : *assets) views.push_back(&asset->view());
  ReplayOptions options = command.options;
  options.scene = choice->scene;
  if (choice->device.profile != nullptr)
    options.encoder_step = choice->device.profile->encoder_step;
  options.marks = source->ticks.marks;
  if (source->recording) {
    options.rate_hz = source->recording->rate_hz;
    const RecordedDevice& device =
        source->recording->devices[static_cast<std::size_t>(command.device)];
    options.encoder_step = device.encoder_step;
    options.stiffness_cap = device.stiffness_cap;
    warn_of_changes(*source->recording, *assets);
    warn_of_scene(*source);
  }
  const ReplayResult result = replay(views, trajectory, options);
  for (const auto& asset : *assets) {
    if (asset->lost()) {
      return fail(ExitCode::file_or_device,
                  asset->path() + ": was cut short while it was read; bake it again");
    }
  }
  const Result<void> written = write_replay(command.out, trajectory, result, options.rate_hz);
  if (!written) return tl::make_unexpected(written.error());
  return report_of(command, *choice, *assets, options, *source, result);
}

std::string to_text(const ordered_json& report) {
  const ordered_json& us = report["us_per_tick"];
  const ordered_json& step = report["force_step_n"];
  const std::string how = report.contains("scene")
                              ? fmt::format("in a scene of {} object{}", report["objects"].size(),
                                            report["objects"].size() == 1 ? "" : "s")
                              : fmt::format("by {}", report["method"].get<std::string>());
  std::string text = fmt::format(
      "{} ticks {}, {} in contact\n"
      "a tick takes {:.3f} us on average (p50 {:.3f}, p99 {:.3f}, p99.9 {:.3f}, max {:.3f})\n"
      "force steps from tick to tick: p50 {:.4f}, p99 {:.4f}, p99.9 {:.4f}, max {:.4f} N\n"
      "forces in {}\n",
      report["ticks"].get<std::uint64_t>(), how, report["contact_ticks"].get<std::uint64_t>(),
      us["mean"].get<double>(), us["p50"].get<double>(), us["p99"].get<double>(),
      us["p999"].get<double>(), us["max"].get<double>(), step["p50"].get<double>(),
      step["p99"].get<double>(), step["p999"].get<double>(), step["max"].get<double>(),
      report["out"].get<std::string>());
  if (report.contains("recording")) text += comparison_text(report["recording"]);
  return text;
}

int execute(const ReplayCommand& command) {
  cli::configure_messages(command.global);
  const Result<ordered_json> report = replay_file(command);
  if (!report) return cli::report(report.error());
  if (command.global.json) {
    cli::print_json(*report);
  } else if (!command.global.quiet) {
    fmt::print("{}", to_text(*report));
  }
  return static_cast<int>(ExitCode::done);
}

}  // namespace

void add_replay_command(CLI::App& program, Action& action) {
  auto command = std::make_shared<ReplayCommand>();
  CLI::App* app =
      program.add_subcommand("replay", "Run the loop's force law on recorded positions");
  cli::add_global_options(*app, command->global);
  app->add_option("trajectory", command->trajectory,
                  "Positions, 'x y z' or 'x y z qw qx qy qz' in metres a line, a line a tick; or a "
                  "recording of run --record, whose rate it then takes")
      ->type_name("TRAJECTORY")
      ->required();
  app->add_option("--out", command->out, "Table to write, CSV")->type_name("FILE")->required();
  add_number(*app, "--device-number", 0, 65535, command->device,
             "Which device of a recording, counted from 0 (default 0)")
      ->type_name("N");
  add_rate_option(*app, command->options.rate_hz);
  cli::add_choice<Pace>(*app, "--pace", command->options.pace,
                        {{"none", Pace::none}, {"realtime", Pace::realtime}},
                        "One tick after the other (default none), or each at its time");
  add_force_options(*app, command->force);
  app->callback([command, &action] { action = [command] { return execute(*command); }; });
}

}  // namespace spm::servo
