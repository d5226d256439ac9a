// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <CLI/CLI.hpp>
#include <functional>
#include <string>

#include "formats/cli/command_line.hpp"
#include "servo/scene/force_choice.hpp"

namespace spm::servo {

/// What a command does when its options are parsed. Returns the exit code.
using Action = std::function<int()>;

/// Adds --asset, --scene, --method, --paper-rule, --stiffness and --probe.
void add_force_options(CLI::App& command, ForceOptions& options);

/// Adds an option for a plain number from `least` to `most`. Anything else is a usage error that
/// names the range.
CLI::Option* add_number(CLI::App& command, const std::string& name, double least, double most,
                        double& target, const std::string& description);

/// Adds --rate.
void add_rate_option(CLI::App& command, double& rate_hz);

/// Adds `run` and `replay` to the program; the chosen one sets `action`.
void add_run_command(CLI::App& program, Action& action);
void add_replay_command(CLI::App& program, Action& action);

}  // namespace spm::servo
