// SPDX-License-Identifier: Apache-2.0
#include <fmt/format.h>
#include <spdlog/spdlog.h>

#include <algorithm>
#include <memory>
#include <span>

#include "common/base/instruction_set.hpp"
#include "formats/asset/asset_writer.hpp"
#include "formats/asset/mapped_asset.hpp"
#include "formats/motion/recording.hpp"
#include "servo/commands/commands.hpp"
#include "servo/commands/replay_hands.hpp"
#include "servo/commands/replay_recording.hpp"
#include "servo/commands/replay_source.hpp"
#include "servo/loop/replay.hpp"
#include "servo/loop/run_messages.hpp"
#include "servo/loop/run_report.hpp"
#include "servo/scene/force_choice.hpp"
#include "servo/scene/scene_assets.hpp"
#include "servo/scene/tool_choice.hpp"

namespace spm::servo {

namespace {

using nlohmann::ordered_json;

struct ReplayCommand {
  cli::GlobalOptions global;
  std::string trajectory, out, record;
  double device = -1;  ///< index of the recording's device; below 0: all
  ForceOptions force;
  ReplayOptions options;
};

using Assets = std::vector<std::unique_ptr<MappedAsset>>;

ordered_json asset_json(const std::string& path, const MappedAsset& asset) {
  return {{"path", path},
          {"form", to_string(asset.metadata().form)},
          {"planes", asset.view().planes.size()},
          {"bytes", asset.bytes().total},
          {"content_sha256", asset.content_sha256()}};
}

/// The device numbers that are replayed. Errors: usage.
Result<std::vector<std::size_t>> devices_of(const ReplayCommand& command,
                                            const ReplaySource& source) {
  if (!source.recording) return std::vector<std::size_t>{0};
  const std::size_t count = source.recording->header.devices.size();
  std::vector<std::size_t> list;
  if (command.device < 0) {
    for (std::size_t i = 0; i < count; ++i) list.push_back(i);
    return list;
  }
  if (const auto known = check_device_number(command.device, command.trajectory, count); !known) {
    return tl::make_unexpected(known.error());
  }
  list.push_back(static_cast<std::size_t>(command.device));
  return list;
}

/// Forces that came from another scene than the replayed one cannot be compared.
void warn_of_scene(const RecordedTicks& ticks) {
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

void warn_of_unknown(const Played& played) {
  const RecordedTicks& ticks = played.ticks;
  if (played.comparable < ticks.ticks.size()) {
    spdlog::warn(
        "from tick {} of the recording on its forces came from assets that are not there any more, "
        "or changes were lost: only the {} ticks before it are compared",
        ticks.ticks[played.comparable], played.comparable);
  }
  if (ticks.settled > 0) {
    spdlog::warn(
        "the recording begins in the middle of a run: its first {} ticks are not compared, because "
        "what was felt before them is not known",
        std::min(ticks.settled, ticks.ticks.size()));
  }
}

ordered_json recording_json(const ReplaySource& source, const std::vector<Played>& all,
                            const std::vector<std::string>& differs) {
  ordered_json json = {{"spm_version", source.recording->header.spm_version},
                       {"instruction_set", source.recording->header.instruction_set}};
  std::uint64_t lost = 0, added = 0, compared = 0, differing = 0;
  double largest = 0, largest_torque = 0;
  const Played* first = nullptr;
  for (const Played& one : all) {
    lost += one.ticks.lost;
    added += one.ticks.added;
    compared += one.comparable - std::min(one.ticks.settled, one.comparable);
    differing += one.found.ticks;
    largest = std::max(largest, one.found.largest);
    largest_torque = std::max(largest_torque, one.found.largest_torque);
    if (first == nullptr && one.found.ticks > 0) first = &one;
  }
  json["lost"] = lost;
  json["ticks_with_added_force"] = added;
  json["compared_ticks"] = compared;
  json["scene_changed"] = nullptr;
  json["forces_equal"] = compared == 0 ? ordered_json(nullptr) : ordered_json(differing == 0);
  json["differing_ticks"] = differing;
  json["largest_difference_n"] = largest;
  json["largest_difference_n_m"] = largest_torque;
  json["differs"] = differs;
  if (first != nullptr) {
    json["first_difference_row"] = first->found.first_row;
    json["first_difference_tick"] = first->ticks.ticks[first->found.first_row];
    json["first_difference_device"] = first->device;
  }
  const RecordedTicks& ticks = all.front().ticks;
  if (!source.own_scene && ticks.change != SceneChange::none) {
    json["scene_changed"] = {{"tick", ticks.changed_tick},
                             {"row", ticks.comparable},
                             {"by", ticks.change == SceneChange::edit ? "edit" : "application"}};
  }
  return json;
}

/// The largest differences, torque where there is any.
std::string largest_text(const ordered_json& recording) {
  std::string text = fmt::format("{:.3g} N", recording["largest_difference_n"].get<double>());
  const auto torque = recording["largest_difference_n_m"].get<double>();
  return torque > 0 ? text + fmt::format(" and {:.3g} N m", torque) : text;
}

/// How the forces compare with the recorded ones, as one line.
std::string comparison_text(const ordered_json& recording) {
  const auto differing = recording["differing_ticks"].get<std::uint64_t>();
  const auto compared = recording["compared_ticks"].get<std::uint64_t>();
  if (recording["forces_equal"].is_null()) {
    return "none of the recording's forces can be compared\n";
  }
  if (differing > 0) {
    return fmt::format("{} forces differ from the recording's, by {} at most\n", differing,
                       largest_text(recording));
  }
  return fmt::format("{} forces equal those of the recording, bit by bit\n", compared);
}

ordered_json report_of(const ReplayCommand& command, const ReplaySource& source,
                       const Assets& assets, const ReplayOptions& options,
                       const ReplayResult& result) {
  const ForceChoice& choice = source.choice;
  const Summary us = us_per_tick(result);
  ordered_json times = {{"mean", us.mean}, {"sd", us.sd}};
  times.update(percentiles_json(us));
  ordered_json report = {{"ticks", result.contacts.size()},
                         {"contact_ticks", contact_ticks(result)}};
  add_forces(report, choice);
  report["us_per_tick"] = std::move(times);
  report["force_step_n"] = percentiles_json(force_steps(result));
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
  if (!command.out.empty()) report["out"] = command.out;
  if (!command.record.empty()) report["record"] = command.record;
  return report;
}

Result<Assets> open_assets(const ForceChoice& choice) {
  MapOptions map;
  map.prefault = true;
  map.lock = true;
  Assets assets;
  for (std::size_t i = 0; i < choice.assets.size(); ++i) {
    auto asset = MappedAsset::open(choice.assets[i], map);
    if (!asset) return at_place(place_of_asset(choice, i), asset.error());
    if (auto checked = check_asset((*asset)->metadata(), choice, i); !checked) {
      return tl::make_unexpected(std::move(checked.error()));
    }
    assets.push_back(std::move(*asset));
  }
  return assets;
}

std::vector<const AssetView*> views_of(const Assets& assets) {
  std::vector<const AssetView*> views;
  for (const auto& asset : assets) views.push_back(&asset->view());
  return views;
}

std::vector<std::string> hashes_of(const Assets& assets) {
  std::vector<std::string> list;
  for (const auto& asset : assets) list.push_back(asset->content_sha256());
  return list;
}

/// `differs`: settings or assets are not the recording's.
Result<void> compare(const ReplaySource& source, const Assets& assets, bool differs,
                     Played& played) {
  for (const auto& asset : assets) {
    if (asset->lost()) {
      return fail(ExitCode::file_or_device,
                  asset->path() + ": was cut short while it was read; bake it again");
    }
  }
  if (!source.recording) return {};
  const auto wanted = std::span(played.ticks.wanted).first(played.comparable);
  std::size_t& settled = played.ticks.settled;
  if (settled > 0) settled = std::min(settled, caught_up(played.result, wanted));
  // Then the reason is no unknown state.
  if (differs && settled >= wanted.size()) settled = 0;
  played.found = difference(played.result, wanted, std::min(settled, played.comparable));
  if (source.own_scene) {
    warn_of_unknown(played);
  } else {
    warn_of_scene(played.ticks);
  }
  return {};
}

/// Forces that differ without a setting or an asset that differs are told as what they are.
std::vector<std::string> causes_of(const ReplaySource& source,
                                   const std::vector<std::string>& hashes,
                                   const std::vector<Played>& all) {
  std::vector<std::string> list = replay_differences(source, hashes);
  const bool differ =
      std::any_of(all.begin(), all.end(), [](const Played& one) { return one.found.ticks > 0; });
  if (list.empty() && differ) {
    list.emplace_back("no setting and no asset: this program computes other forces");
  }
  return list;
}

/// A path is of one hand; the tools of a scene's others are not there.
void warn_of_other_tools(const ReplaySource& source) {
  const std::size_t tools = tools_of(source.choice.scene);
  if (source.recording || tools < 2) return;
  spdlog::warn(
      "{}: the scene has {} tools, and a file of positions is of one hand: it holds the first "
      "tool, "
      "and the others are not there; run the scene with --record for all of them",
      source.choice.scene_path, tools);
}

Result<ordered_json> replay_file(const ReplayCommand& command) {
  for (const std::string& path : {command.out, command.record}) {
    if (path.empty()) continue;
    if (auto checked = check_output_path(path); !checked) {
      return tl::make_unexpected(std::move(checked.error()));
    }
  }
  const auto source = read_replay_source(command.trajectory, command.force);
  if (!source) return tl::make_unexpected(source.error());
  for (const std::string& text : paper_warnings(source->choice)) spdlog::warn("{}", text);
  warn_of_other_tools(*source);
  if (command.out.empty() && command.record.empty() && !source->recording) {
    return fail(ExitCode::usage, "--out is missing; give the table to write, --out OUT.csv");
  }
  const auto devices = devices_of(command, *source);
  if (!devices) return tl::make_unexpected(devices.error());
  const auto assets = open_assets(source->choice);
  if (!assets) return tl::make_unexpected(assets.error());
  const std::vector<std::string> hashes = hashes_of(*assets);
  ReplayOptions options = command.options;
  options.scene = source->choice.scene;
  if (source->choice.device.profile != nullptr) {
    options.encoder_step = source->choice.device.profile->encoder_step;
  }
  options.turning = trajectory_turning(source->choice);
  const std::vector<const AssetView*> views = views_of(*assets);
  const auto tools = tools_for(*source, views);
  if (!tools) return tl::make_unexpected(tools.error());
  const bool differs = source->recording && !replay_differences(*source, hashes).empty();
  std::vector<Played> all;
  for (const std::size_t device : hands_to_play(*source, *devices)) {
    const std::size_t held = tools->size() > 1 ? device : 0;
    options.tool = held < tools->size() ? (*tools)[held].get() : nullptr;
    all.push_back(ticks_to_play(*source, device, hashes, options));
  }
  play_all(options.scene, views, all);
  std::erase_if(all, [&](const Played& one) {
    return std::find(devices->begin(), devices->end(), one.device) == devices->end();
  });
  for (Played& one : all) {
    if (auto compared = compare(*source, *assets, differs, one); !compared) {
      return tl::make_unexpected(std::move(compared.error()));
    }
  }
  const Played& first = all.front();
  if (!command.out.empty()) {
    auto written =
        write_replay(command.out, first.ticks.trajectory, first.result, first.options.rate_hz);
    if (!written) return tl::make_unexpected(std::move(written.error()));
  }
  if (!command.record.empty()) {
    auto written = write_whole(command.record, replayed_recording(*source, hashes, all));
    if (!written) return tl::make_unexpected(std::move(written.error()));
  }
  ordered_json report = report_of(command, *source, *assets, first.options, first.result);
  if (source->recording) {
    report["recording"] = recording_json(*source, all, causes_of(*source, hashes, all));
  }
  return report;
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
      "force steps from tick to tick: p50 {:.4f}, p99 {:.4f}, p99.9 {:.4f}, max {:.4f} N\n",
      report["ticks"].get<std::uint64_t>(), how, report["contact_ticks"].get<std::uint64_t>(),
      us["mean"].get<double>(), us["p50"].get<double>(), us["p99"].get<double>(),
      us["p999"].get<double>(), us["max"].get<double>(), step["p50"].get<double>(),
      step["p99"].get<double>(), step["p999"].get<double>(), step["max"].get<double>());
  if (report.contains("out")) text += "forces in " + report["out"].get<std::string>() + "\n";
  if (report.contains("record"))
    text += "recorded in " + report["record"].get<std::string>() + "\n";
  if (report.contains("recording")) text += comparison_text(report["recording"]);
  return text;
}

/// Says in what the replay differs from the recording, and whether that was felt.
int verdict_of(const ReplayCommand& command, const ordered_json& recording) {
  std::string causes;
  for (const ordered_json& cause : recording["differs"]) {
    causes += (causes.empty() ? "" : "; ") + cause.get<std::string>();
  }
  const auto differing = recording["differing_ticks"].get<std::uint64_t>();
  if (differing == 0) {
    if (!causes.empty()) spdlog::warn("what differs from the recording: {}", causes);
    return static_cast<int>(ExitCode::done);
  }
  return cli::report(
      Error{ExitCode::tolerance_not_met,
            fmt::format("{}: {} of {} forces differ from the recording's, by up to {}, first "
                        "at tick {}; what differs: {}",
                        command.trajectory, differing,
                        recording["compared_ticks"].get<std::uint64_t>(), largest_text(recording),
                        recording["first_difference_tick"].get<std::uint64_t>(), causes)});
}

int execute_replay(const ReplayCommand& command) {
  cli::configure_messages(command.global);
  const Result<ordered_json> report = replay_file(command);
  if (!report) return cli::report(report.error());
  if (command.global.json) {
    cli::print_json(*report);
  } else if (!command.global.quiet) {
    fmt::print("{}", to_text(*report));
  }
  return report->contains("recording") ? verdict_of(command, (*report)["recording"])
                                       : static_cast<int>(ExitCode::done);
}

}  // namespace

Command add_replay_command(CLI::App& program) {
  auto command = std::make_shared<ReplayCommand>();
  CLI::App* app =
      program.add_subcommand("replay", "Run the loop's force law on recorded positions");
  cli::add_global_options(*app, command->global);
  app->add_option("trajectory", command->trajectory,
                  "Positions, 'x y z' or 'x y z qw qx qy qz' in metres a line, a line a tick; or a "
                  "recording of run --record, which needs no other option")
      ->type_name("TRAJECTORY")
      ->required();
  app->add_option("--out", command->out, "Table to write, CSV; of the first device")
      ->type_name("FILE");
  app->add_option("--record", command->record,
                  "Recording to write, of the forces of the replay: to look at with 'view "
                  "--recording', beside that of another method")
      ->type_name("FILE");
  add_device_number(*app, command->device,
                    "Which device of a recording, counted from 0 (default all)");
  add_rate_option(*app, command->options.rate_hz);
  cli::add_choice<Pace>(*app, "--pace", command->options.pace,
                        {{"none", Pace::none}, {"realtime", Pace::realtime}},
                        "One tick after the other (default none), or each at its time");
  add_force_options(*app, command->force);
  return {app, [command] { return execute_replay(*command); }};
}

}  // namespace spm::servo
