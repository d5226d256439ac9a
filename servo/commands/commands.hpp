// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <CLI/CLI.hpp>
#include <cstddef>
#include <string>

#include "formats/cli/command_line.hpp"
#include "formats/cli/program.hpp"
#include "servo/scene/force_choice.hpp"

namespace spm::servo {

using cli::Command;

/// Adds --asset, --scene, --method, --paper-rule, --stiffness and --probe.
void add_force_options(CLI::App& command, ForceOptions& options);

/// Adds an option for a plain number from `min` to `max`. Anything else is a usage error that
/// names the range.
CLI::Option* add_number(CLI::App& command, const std::string& name, double min, double max,
                        double& target, const std::string& description);

/// Adds --rate.
void add_rate_option(CLI::App& command, double& rate_hz);

/// Adds --device-number, of a recording.
void add_device_number(CLI::App& command, double& number, const std::string& description);
/// Errors: usage, where a recording is of so many devices and none has the number.
[[nodiscard]] Result<void> check_device_number(double number, const std::string& recording,
                                               std::size_t devices);

/// Serves forces to devices.
[[nodiscard]] Command add_run_command(CLI::App& program);
/// Runs the loop's force law on recorded positions.
[[nodiscard]] Command add_replay_command(CLI::App& program);
/// What is plugged in, and whose permission is missing.
[[nodiscard]] Command add_devices_command(CLI::App& program);
/// Whether this machine is fit for the loop.
[[nodiscard]] Command add_doctor_command(CLI::App& program);
/// Supervisors for daemons that may be paused with their container.
[[nodiscard]] Command add_supervise_command(CLI::App& program);
/// The running daemon, live.
[[nodiscard]] Command add_top_command(CLI::App& program);
/// The running daemon in a browser.
[[nodiscard]] Command add_view_command(CLI::App& program);
/// A recording in the open format of other viewers.
[[nodiscard]] Command add_export_mcap_command(CLI::App& program);
/// A recording as a drawing.
[[nodiscard]] Command add_plot_command(CLI::App& program);

}  // namespace spm::servo
