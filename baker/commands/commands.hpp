// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <CLI/CLI.hpp>
#include <functional>

namespace spm::baker {

/// A sub-command: its options, and what it does once they are parsed. `run` returns the exit code,
/// or throws BakeError.
struct Command {
  CLI::App* options = nullptr;
  std::function<int()> run;
};

[[nodiscard]] Command add_build_command(CLI::App& app);
[[nodiscard]] Command add_info_command(CLI::App& app);
[[nodiscard]] Command add_verify_command(CLI::App& app);
[[nodiscard]] Command add_query_command(CLI::App& app);
[[nodiscard]] Command add_export_command(CLI::App& app);
[[nodiscard]] Command add_batch_command(CLI::App& app);

}  // namespace spm::baker
