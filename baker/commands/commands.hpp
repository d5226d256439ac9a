// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <CLI/CLI.hpp>

#include "formats/cli/program.hpp"

namespace spm::baker {

/// A command of the baker may throw BakeError.
using cli::Command;

[[nodiscard]] Command add_build_command(CLI::App& app);
[[nodiscard]] Command add_info_command(CLI::App& app);
[[nodiscard]] Command add_verify_command(CLI::App& app);
[[nodiscard]] Command add_query_command(CLI::App& app);
[[nodiscard]] Command add_export_command(CLI::App& app);
[[nodiscard]] Command add_batch_command(CLI::App& app);
[[nodiscard]] Command add_cache_command(CLI::App& app);
[[nodiscard]] Command add_merge_command(CLI::App& app);

}  // namespace spm::baker
