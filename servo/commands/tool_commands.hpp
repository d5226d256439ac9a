// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "servo/commands/commands.hpp"

namespace spm::servo {

/// Adds `devices`: what is plugged in, and for which devices permission is missing.
void add_devices_command(CLI::App& program, Action& action);

/// Adds `doctor`: whether this machine is fit for the loop.
void add_doctor_command(CLI::App& program, Action& action);

/// Adds `top`: what the running daemon does, live.
void add_top_command(CLI::App& program, Action& action);

/// Adds `plot`: a recording as a drawing.
void add_plot_command(CLI::App& program, Action& action);

}  // namespace spm::servo
