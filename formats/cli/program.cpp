// SPDX-License-Identifier: Apache-2.0
#include "formats/cli/program.hpp"

#include <fcntl.h>
#include <unistd.h>

#include <iostream>
#include <utility>

#include "formats/cli/command_line.hpp"

namespace spm::cli {

namespace {

/// Opens /dev/null where the program was started without a standard file. Otherwise the next file
/// or device that is opened takes its number, and is written the program's messages.
void hold_standard_files() noexcept {
  for (int number = STDIN_FILENO; number <= STDERR_FILENO; ++number) {
    if (fcntl(number, F_GETFD) < 0) static_cast<void>(open("/dev/null", O_RDWR | O_NOCTTY));
  }
}

}  // namespace

int run_program(CLI::App& app, int argc, const char* const* argv, std::span<const Command> commands,
                const Describe& describe) {
  hold_standard_files();
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
