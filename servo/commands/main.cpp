// SPDX-License-Identifier: Apache-2.0
#include <array>
#include <cstddef>
#include <string>

#include "servo/commands/commands.hpp"
#include "servo/loop/supervisor_program.hpp"

// NOLINTNEXTLINE(bugprone-exception-escape): without memory for its options it can only end.
int main(int argc, char** argv) {
  const auto supervised = spm::servo::be_supervisor_program({argv, static_cast<std::size_t>(argc)});
  if (supervised) return *supervised;
  CLI::App program("Serves forces to haptic devices from objects that spm-bake baked", "spm-servo");
  const std::array commands{
      spm::servo::add_run_command(program),      spm::servo::add_replay_command(program),
      spm::servo::add_devices_command(program),  spm::servo::add_doctor_command(program),
      spm::servo::add_top_command(program),      spm::servo::add_view_command(program),
      spm::servo::add_plot_command(program),     spm::servo::add_export_mcap_command(program),
      spm::servo::add_supervise_command(program)};
  return spm::cli::run_program(program, argc, argv, commands, [](const std::exception& problem) {
    return spm::Error{spm::ExitCode::internal, std::string("internal failure: ") + problem.what() +
                                                   "; please report it with the command line"};
  });
}
