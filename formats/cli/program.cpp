// SPDX-License-Identifier: Apache-2.0
#include "formats/cli/program.hpp"

#include <iostream>
#include <utility>

#include "formats/cli/command_line.hpp"

namespace spm::cli {

int run_program(CLI::App& app, int argc, const char* const* argv, std::span<const Command> commands,
                const Describe& describe) {
  try {
    app.require_subcommand(1);
    if (const auto code = parse(app, argc, argv)) return *code;
    for (const Command& command : commands) {
      if (command.options->parsed()) return command.run();
    }
  } catch (const std::exception& problem) {
    return report(describe(problem));
  }
  return static_cast<int>(ExitCode::internal);
}

Command with_checked_output(Command command) {
  return {command.options, [run = std::move(command.run)] {
            const int code = run();
            if (std::cout.flush()) return code;
            return report({ExitCode::file_or_device,
                           "standard output: cannot be written; is the disk full or the reader "
                           "gone?"});
          }};
}

}  // namespace spm::cli
