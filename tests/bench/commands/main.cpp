// SPDX-License-Identifier: GPL-3.0-or-later
#include <CLI/CLI.hpp>
#include <array>
#include <exception>
#include <iostream>
#include <new>

#include "baker/base/bake_error.hpp"
#include "formats/cli/command_line.hpp"
#include "tests/bench/commands/commands.hpp"

namespace {

int run(const spm::bench::Command& command) {
  try {
    const int code = command.run();
    if (!std::cout.flush()) {
      return spm::cli::report(
          {spm::ExitCode::file_or_device,
           "standard output: cannot be written; is the disk full or the reader gone?"});
    }
    return code;
  } catch (const spm::baker::BakeError& error) {
    return spm::cli::report({error.code(), error.what()});
  } catch (const std::bad_alloc&) {
    return spm::cli::report(
        {spm::ExitCode::internal, "out of memory; measure with --quick or fewer methods"});
  } catch (const std::exception& error) {
    return spm::cli::report({spm::ExitCode::internal, error.what()});
  }
}

}  // namespace

int main(int argc, char** argv) {
  CLI::App app{"Measures the baked form beside other ways to answer distance and direction.",
               "spm-bench"};
  app.require_subcommand(1);
  const std::array commands{
      spm::bench::add_bytes_command(app),     spm::bench::add_forces_command(app),
      spm::bench::add_methods_command(app),   spm::bench::add_sixdof_command(app),
      spm::bench::add_stability_command(app), spm::bench::add_tables_command(app)};
  if (const auto code = spm::cli::parse(app, argc, argv)) return *code;
  for (const spm::bench::Command& command : commands) {
    if (command.options->parsed()) return run(command);
  }
  return static_cast<int>(spm::ExitCode::internal);
}
