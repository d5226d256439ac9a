// SPDX-License-Identifier: GPL-3.0-or-later
#include <malloc.h>

#include <CLI/CLI.hpp>
#include <array>

#include "baker/base/bake_error.hpp"
#include "baker/commands/commands.hpp"

int main(int argc, char** argv) {
  // Bakes take and give back the same large pieces again and again: the system need not clear them.
  constexpr int largest_piece = 32 << 20,
                kept = 1 << 30;  // the first is the most that may be asked
  mallopt(M_MMAP_THRESHOLD, largest_piece);
  mallopt(M_TRIM_THRESHOLD, kept);
  CLI::App app{"Bakes a mesh into support planes and distance maps, and looks at what was baked.",
               "spm-bake"};
  std::array commands{spm::baker::add_build_command(app),  spm::baker::add_info_command(app),
                      spm::baker::add_verify_command(app), spm::baker::add_query_command(app),
                      spm::baker::add_export_command(app), spm::baker::add_batch_command(app),
                      spm::baker::add_cache_command(app),  spm::baker::add_merge_command(app)};
  for (auto& command : commands) command = spm::cli::with_checked_output(command);
  return spm::cli::run_program(app, argc, argv, commands, [](const std::exception& problem) {
    return spm::baker::error_of(problem,
                                "bake with a larger --tolerance or a smaller --resolution");
  });
}
