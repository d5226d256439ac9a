// SPDX-License-Identifier: Apache-2.0
#include <fmt/format.h>

#include <memory>

#include "formats/mapped_asset.hpp"
#include "servo/commands.hpp"
#include "servo/force_choice.hpp"
#include "servo/replay.hpp"
#include "servo/run_report.hpp"

namespace spm::servo {

namespace {

using nlohmann::ordered_json;

struct ReplayCommand {
  cli::GlobalOptions global;
  std::string trajectory, out;
  ForceOptions force;
  ReplayOptions options;
};

struct Replayed {
  ReplayResult result;
  ordered_json report;
};

using Assets = std::vector<std::unique_ptr<MappedAsset>>;

ordered_json asset_json(const std::string& path, const MappedAsset& asset) {
  return {{"path", path},
          {"form", to_string(asset.metadata().form)},
          {"planes", asset.view().planes.size()},
          {"bytes", asset.bytes().total},
          {"content_sha256", asset.content_sha256()}};
}

ordered_json report_of(const ReplayCommand& command, const ForceChoice& choice,
                       const Assets& assets, const ReplayResult& result) {
  const Summary us = us_per_tick(result);
  ordered_json times = {{"mean", us.mean}, {"sd", us.sd}};
  times.update(percentiles_json(us));
  ordered_json report = {{"ticks", result.contacts.size()},
                         {"contact_ticks", contact_ticks(result)}};
  add_forces(report, choice);
  report["us_per_tick"] = std::move(times);
  report["force_step_n"] = percentiles_json(force_steps(result));
  report["rate_hz"] = command.options.rate_hz;
  report["pace"] = command.options.pace == Pace::realtime ? "realtime" : "none";
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
  const auto trajectory = read_trajectory(command.trajectory);
  if (!trajectory) return tl::make_unexpected(trajectory.error());
  const auto assets = open_assets(*choice);
  if (!assets) return tl::make_unexpected(assets.error());
  std::vector<const AssetView*> views;
  for (const auto& asset : *assets) views.push_back(&asset->view());
  ReplayOptions options = command.options;
  options.scene = choice->scene;
  if (choice->device.profile != nullptr)
    options.encoder_step = choice->device.profile->encoder_step;
  const ReplayResult result = replay(views, *trajectory, options);
  for (const auto& asset : *assets) {
    if (asset->lost()) {
      return fail(ExitCode::file_or_device,
                  asset->path() + ": was cut short while it was read; bake it again");
    }
  }
  const Result<void> written = write_replay(command.out, *trajectory, result, options.rate_hz);
  if (!written) return tl::make_unexpected(written.error());
  return report_of(command, *choice, *assets, result);
}

std::string to_text(const ordered_json& report) {
  const ordered_json& us = report["us_per_tick"];
  const ordered_json& step = report["force_step_n"];
  const std::string how = report.contains("scene")
                              ? fmt::format("in a scene of {} object{}", report["objects"].size(),
                                            report["objects"].size() == 1 ? "" : "s")
                              : fmt::format("by {}", report["method"].get<std::string>());
  return fmt::format(
      "{} ticks {}, {} in contact\n"
      "a tick takes {:.3f} us on average (p50 {:.3f}, p99 {:.3f}, p99.9 {:.3f}, max {:.3f})\n"
      "force steps from tick to tick: p50 {:.4f}, p99 {:.4f}, p99.9 {:.4f}, max {:.4f} N\n"
      "forces in {}\n",
      report["ticks"].get<std::uint64_t>(), how, report["contact_ticks"].get<std::uint64_t>(),
      us["mean"].get<double>(), us["p50"].get<double>(), us["p99"].get<double>(),
      us["p999"].get<double>(), us["max"].get<double>(), step["p50"].get<double>(),
      step["p99"].get<double>(), step["p999"].get<double>(), step["max"].get<double>(),
      report["out"].get<std::string>());
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
                  "Positions, 'x y z' or 'x y z qw qx qy qz' in metres a line, a line a tick")
      ->type_name("TRAJECTORY")
      ->required();
  app->add_option("--out", command->out, "Table to write, CSV")->type_name("FILE")->required();
  add_rate_option(*app, command->options.rate_hz);
  cli::add_choice<Pace>(*app, "--pace", command->options.pace,
                        {{"none", Pace::none}, {"realtime", Pace::realtime}},
                        "One tick after the other (default none), or each at its time");
  add_force_options(*app, command->force);
  app->callback([command, &action] { action = [command] { return execute(*command); }; });
}

}  // namespace spm::servo
