// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <CLI/CLI.hpp>
#include <exception>
#include <functional>
#include <span>

#include "common/base/error.hpp"

namespace spm::cli {

/// A sub-command: its options, and what it does once they were parsed. `run` returns the exit code
/// or throws.
struct Command {
  CLI::App* options = nullptr;
  std::function<int()> run;
};

/// What to say of an exception that left a command.
using Describe = std::function<Error(const std::exception&)>;

/// Parses the command line and runs the command that it names; gives the program's exit code.
[[nodiscard]] int run_program(CLI::App& app, int argc, const char* const* argv,
                              std::span<const Command> commands, const Describe& describe);

/// The command, but it fails where standard output cannot be written.
[[nodiscard]] Command with_checked_output(Command command);

}  // namespace spm::cli
