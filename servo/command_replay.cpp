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
  std::string trajectory, asset, out;
  ReplayOptions options;
};

struct Replayed {
  ReplayResult result;
  ordered_json report;
};

ordered_json report_of(const ReplayCommand& command, const MappedAsset& asset,
                       const ReplayResult& result) {
  const ForceSettings& force = command.options.force;
  const Summary us = us_per_tick(result);
  ordered_json times = {{"mean", us.mean}, {"sd", us.sd}};
  times.update(percentiles_json(us));
  ordered_json report = {{"ticks", result.contacts.size()},
                         {"contact_ticks", contact_ticks(result)},
                         {"method", to_string(force.method)}};
  if (force.method == Method::paper) report["paper_rule"] = to_string(force.rule);
  report["us_per_tick"] = std::move(times);
  report["force_step_n"] = percentiles_json(force_steps(result));
  report["stiffness_n_m"] = force.stiffness;
  report["probe_radius_m"] = force.probe_radius;
  report["rate_hz"] = command.options.rate_hz;
  report["pace"] = command.options.pace == Pace::realtime ? "realtime" : "none";
  report["asset"] = {{"path", command.asset},
                     {"form", to_string(asset.metadata().form)},
                     {"planes", asset.view().planes.size()},
                     {"bytes", asset.bytes().total},
                     {"content_sha256", asset.content_sha256()}};
  report["out"] = command.out;
  return report;
}

Result<ordered_json> replay_file(const ReplayCommand& command) {
  if (auto checked = check_settings(command.options.force); !checked) {
    return tl::make_unexpected(std::move(checked.error()));
  }
  if (auto checked = check_output_path(command.out); !checked) {
    return tl::make_unexpected(std::move(checked.error()));
  }
  const auto trajectory = read_trajectory(command.trajectory);
  if (!trajectory) return tl::make_unexpected(trajectory.error());
  MapOptions map;
  map.prefault = true;
  map.lock = true;
  const auto asset = MappedAsset::open(command.asset, map);
  if (!asset) return tl::make_unexpected(asset.error());
  const MappedAsset& mapped = **asset;
  if (auto checked = check_asset(mapped.metadata(), command.options.force, command.asset);
      !checked) {
    return tl::make_unexpected(std::move(checked.error()));
  }
  const ReplayResult result = replay(mapped.view(), *trajectory, command.options);
  if (mapped.lost()) {
    return fail(ExitCode::file_or_device,
                command.asset + ": was cut short while it was read; bake it again");
  }
  const Result<void> written =
      write_replay(command.out, *trajectory, result, command.options.rate_hz);
  if (!written) return tl::make_unexpected(written.error());
  return report_of(command, mapped, result);
}

std::string to_text(const ordered_json& report) {
  const ordered_json& us = report["us_per_tick"];
  const ordered_json& step = report["force_step_n"];
  return fmt::format(
      "{} ticks by {}, {} in contact\n"
      "a tick takes {:.3f} us on average (p50 {:.3f}, p99 {:.3f}, p99.9 {:.3f}, max {:.3f})\n"
      "force steps from tick to tick: p50 {:.4f}, p99 {:.4f}, p99.9 {:.4f}, max {:.4f} N\n"
      "forces in {}\n",
      report["ticks"].get<std::uint64_t>(), report["method"].get<std::string>(),
      report["contact_ticks"].get<std::uint64_t>(), us["mean"].get<double>(),
      us["p50"].get<double>(), us["p99"].get<double>(), us["p999"].get<double>(),
      us["max"].get<double>(), step["p50"].get<double>(), step["p99"].get<double>(),
      step["p999"].get<double>(), step["max"].get<double>(), report["out"].get<std::string>());
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
  app->add_option("--asset", command->asset, "Baked asset, FILE.spm.exr")
      ->type_name("FILE")
      ->required();
  app->add_option("--out", command->out, "Table to write, CSV")->type_name("FILE")->required();
  add_rate_option(*app, command->options.rate_hz);
  cli::add_choice<Pace>(*app, "--pace", command->options.pace,
                        {{"none", Pace::none}, {"realtime", Pace::realtime}},
                        "One tick after the other (default none), or each at its time");
  add_force_options(*app, command->options.force);
  app->callback([command, &action] { action = [command] { return execute(*command); }; });
}

}  // namespace spm::servo
