// SPDX-License-Identifier: Apache-2.0
#include <fmt/format.h>
#include <spdlog/spdlog.h>

#include <memory>

#include "servo/commands/commands.hpp"
#include "servo/foxglove/mcap_export.hpp"

namespace spm::servo {

namespace {

struct ExportCommand {
  cli::GlobalOptions global;
  std::string recording, out;
};

int execute_export(const ExportCommand& command) {
  cli::configure_messages(command.global);
  const auto written = export_mcap(command.recording, command.out);
  if (!written) return cli::report(written.error());
  if (!written->loss.empty()) spdlog::warn("{}", written->loss);
  if (command.global.json) {
    cli::print_json({{"recording", command.recording},
                     {"out", command.out},
                     {"ticks", written->ticks},
                     {"messages", written->messages},
                     {"topics", written->topics},
                     {"whole", written->loss.empty()}});
  } else if (!command.global.quiet) {
    fmt::print("{} messages of {} ticks written to {}\n", written->messages, written->ticks,
               command.out);
  }
  return static_cast<int>(ExitCode::done);
}

}  // namespace

Command add_export_mcap_command(CLI::App& program) {
  auto command = std::make_shared<ExportCommand>();
  CLI::App* app = program.add_subcommand(
      "export-mcap",
      "Write a recording as MCAP, which Foxglove, Lichtblick, PlotJuggler and others open");
  cli::add_global_options(*app, command->global);
  app->add_option("recording", command->recording,
                  "What run --record wrote, or the black box after a fault")
      ->type_name("RECORDING")
      ->required();
  app->add_option("out", command->out, "File to write")->type_name("OUT.mcap")->required();
  return {app, [command] { return execute_export(*command); }};
}

}  // namespace spm::servo
