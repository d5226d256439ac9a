// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <CLI/CLI.hpp>
#include <functional>

namespace spm::bench {

/// A mode: its options, and what it does once they were parsed. `run` returns the exit code, or
/// throws BakeError.
struct Command {
  CLI::App* options = nullptr;
  std::function<int()> run;
};

[[nodiscard]] Command add_bytes_command(CLI::App& app);
[[nodiscard]] Command add_sixdof_command(CLI::App& app);

}  // namespace spm::bench
