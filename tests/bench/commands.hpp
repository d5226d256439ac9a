// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <CLI/CLI.hpp>
#include <functional>
#include <optional>
#include <string>
#include <vector>

namespace spm::bench {

/// A mode: its options, and what it does once they were parsed. `run` returns the exit code, or
/// throws BakeError.
struct Command {
  CLI::App* options = nullptr;
  std::function<int()> run;
};

[[nodiscard]] Command add_bytes_command(CLI::App& app);
[[nodiscard]] Command add_forces_command(CLI::App& app);
[[nodiscard]] Command add_methods_command(CLI::App& app);
[[nodiscard]] Command add_sixdof_command(CLI::App& app);
[[nodiscard]] Command add_tables_command(CLI::App& app);

/// Options that several modes share; `which` tells what of the table is measured without --mesh.
void add_mesh_option(CLI::App& command, std::vector<std::string>& meshes, const std::string& which);
void add_method_option(CLI::App& command, std::vector<std::string>& methods);

/// Usage errors that several modes share: a tolerance must be above 0, a method one of the mode's.
void check_tolerance(const std::optional<double>& tolerance);
void check_methods(const std::vector<std::string>& asked, const std::vector<std::string>& names);

}  // namespace spm::bench
