// SPDX-License-Identifier: Apache-2.0
#include <exception>

#include "servo/commands/commands.hpp"
#include "servo/commands/tool_commands.hpp"

int main(int argc, char** argv) {
  try {
    CLI::App program("Serves forces to haptic devices from objects that spm-bake baked",
                     "spm-servo");
    program.require_subcommand(1);
    spm::servo::Action action;
    spm::servo::add_run_command(program, action);
    spm::servo::add_replay_command(program, action);
    spm::servo::add_devices_command(program, action);
    spm::servo::add_doctor_command(program, action);
    spm::servo::add_top_command(program, action);
    spm::servo::add_plot_command(program, action);
    if (const auto code = spm::cli::parse(program, argc, argv)) return *code;
    return action();
  } catch (const std::exception& problem) {
    return spm::cli::report(
        {spm::ExitCode::internal, std::string("internal failure: ") + problem.what() +
                                      "; please report it with the command line"});
  }
}
