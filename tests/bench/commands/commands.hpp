// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <CLI/CLI.hpp>
#include <cstdint>
#include <iostream>
#include <optional>
#include <string>
#include <vector>

#include "formats/cli/command_line.hpp"
#include "formats/cli/program.hpp"

namespace spm::bench {

/// A mode of the bench may throw BakeError.
using cli::Command;

[[nodiscard]] Command add_bytes_command(CLI::App& app);
[[nodiscard]] Command add_forces_command(CLI::App& app);
[[nodiscard]] Command add_methods_command(CLI::App& app);
[[nodiscard]] Command add_sixdof_command(CLI::App& app);
[[nodiscard]] Command add_stability_command(CLI::App& app);
[[nodiscard]] Command add_tables_command(CLI::App& app);

/// Returns the result of `measure(progress)` and shows a progress line meanwhile.
template <class Measure>
[[nodiscard]] auto measured(const cli::GlobalOptions& global, const Measure& measure) {
  cli::ProgressLine line(global);
  return measure(
      [&line](const std::string& what, double done) { line.update(what.c_str(), done); });
}

/// Prints a report as asked for: `json()` or `text()`, or nothing.
template <class Json, class Text>
void print_report(const cli::GlobalOptions& global, const Json& json, const Text& text) {
  if (global.json) {
    cli::print_json(json());
  } else if (!global.quiet) {
    std::cout << text();
  }
}

/// Options that several modes share; `which` says which table meshes are measured without --mesh.
void add_mesh_option(CLI::App& command, std::vector<std::string>& meshes, const std::string& which);
void add_method_option(CLI::App& command, std::vector<std::string>& methods);
/// `what` describes the purpose of the number. The number must outlive the command.
void add_seed_option(CLI::App& command, std::uint64_t& seed, const std::string& what);
void add_threads_option(CLI::App& command, unsigned& threads, const std::string& what);
void add_bakes_option(CLI::App& command, std::string& folder);

/// Usage errors of several modes: a tolerance must be above 0, a method must belong to the mode.
void check_tolerance(const std::optional<double>& tolerance);
void check_methods(const std::vector<std::string>& asked, const std::vector<std::string>& names);

}  // namespace spm::bench
