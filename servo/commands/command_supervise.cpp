// SPDX-License-Identifier: Apache-2.0
#include <spdlog/spdlog.h>

#include <memory>
#include <string>

#include "servo/commands/commands.hpp"
#include "servo/loop/outside_supervisor.hpp"
#include "servo/realtime/stop_signals.hpp"
#include "servo/record/black_box_files.hpp"

namespace spm::servo {

namespace {

struct SuperviseCommand {
  cli::GlobalOptions global;
  OutsideSupervisors supervisors;
};

int execute_supervise(const SuperviseCommand& command) {
  cli::configure_messages(command.global);
  OutsideSupervisors supervisors = command.supervisors;
  supervisors.black_box = default_black_box();
  supervisors.tell = [](const std::string& text) { spdlog::info("{}", text); };
  supervisors.warn = [](const std::string& text) { spdlog::warn("{}", text); };
  StopSignals signals;
  signals.listen();
  if (auto served = serve_supervisors(supervisors, signals.flag()); !served) {
    return cli::report(served.error());
  }
  return static_cast<int>(ExitCode::done);
}

}  // namespace

Command add_supervise_command(CLI::App& program) {
  auto command = std::make_shared<SuperviseCommand>();
  OutsideSupervisors& supervisors = command->supervisors;
  CLI::App* app = program.add_subcommand("supervise",
                                         "Give daemons in containers a supervisor that is not "
                                         "paused with them: it sends their devices "
                                         "zero force. They ask for it by run --supervisor SOCKET");
  cli::add_global_options(*app, command->global);
  app->add_option("--socket", supervisors.path,
                  "Where daemons ask: a path in a folder that is shared with their containers")
      ->type_name("FILE")
      ->required();
  cli::add_choice<RealtimeMode>(*app, "--realtime", supervisors.realtime,
                                {{"require", RealtimeMode::require},
                                 {"try", RealtimeMode::attempt},
                                 {"off", RealtimeMode::off}},
                                "Real-time priority and locked memory (default try)");
  return {app, [command] { return execute_supervise(*command); }};
}

}  // namespace spm::servo
