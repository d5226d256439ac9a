// SPDX-License-Identifier: GPL-3.0-or-later
#include <CLI/CLI.hpp>
#include <array>

#include "baker/base/bake_error.hpp"
#include "tests/bench/commands/commands.hpp"

int main(int argc, char** argv) {
  CLI::App app{"Measures the baked form beside other ways to answer distance and direction.",
               "spm-bench"};
  std::array commands{spm::bench::add_bytes_command(app),     spm::bench::add_forces_command(app),
                      spm::bench::add_methods_command(app),   spm::bench::add_sixdof_command(app),
                      spm::bench::add_stability_command(app), spm::bench::add_tables_command(app)};
  for (auto& command : commands) command = spm::cli::with_checked_output(command);
  return spm::cli::run_program(app, argc, argv, commands, [](const std::exception& problem) {
    return spm::baker::error_of(problem, "measure with --quick or fewer methods");
  });
}
