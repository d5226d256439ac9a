// SPDX-License-Identifier: GPL-3.0-or-later
#include <CLI/CLI.hpp>
#include <array>
#include <exception>
#include <iostream>
#include <new>

#include "baker/base/bake_error.hpp"
#include "baker/commands/commands.hpp"
#include "formats/cli/command_line.hpp"

namespace {

int run(const spm::baker::Command& command) {
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
        {spm::ExitCode::internal,
         "out of memory; bake with a larger --tolerance or a smaller --resolution"});
  } catch (const std::exception& error) {
    return spm::cli::report({spm::ExitCode::internal, error.what()});
  }
}

}  // namespace

int main(int argc, char** argv) {
  CLI::App app{"Bakes a mesh into support planes and distance maps, and looks at what was baked.",
               "spm-bake"};
  app.require_subcommand(1);
  const std::array commands{
      spm::baker::add_build_command(app),  spm::baker::add_info_command(app),
      spm::baker::add_verify_command(app), spm::baker::add_query_command(app),
      spm::baker::add_export_command(app), spm::baker::add_batch_command(app)};
  if (const auto code = spm::cli::parse(app, argc, argv)) return *code;
  for (const spm::baker::Command& command : commands) {
    if (command.options->parsed()) return run(command);
  }
  return static_cast<int>(spm::ExitCode::internal);
}
