// SPDX-License-Identifier: GPL-3.0-or-later
#include "tests/bench/commands/commands.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <limits>

namespace spm::bench {

void add_mesh_option(CLI::App& command, std::vector<std::string>& meshes,
                     const std::string& which) {
  command
      .add_option("--mesh", meshes,
                  "mesh to measure on, scaled to a diagonal of 100 mm; may be repeated (default: " +
                      which + " of the table, from the folder that SPM_SHARED names)")
      ->allow_extra_args(false)
      ->type_name("FILE");
}

void add_method_option(CLI::App& command, std::vector<std::string>& methods) {
  command.add_option("--method", methods, "measure this one only; may be repeated (default: all)")
      ->allow_extra_args(false)
      ->type_name("NAME");
}

void add_seed_option(CLI::App& command, std::uint64_t& seed, const std::string& what) {
  cli::add_integer(
      command, "--seed", 0, std::numeric_limits<std::uint64_t>::max(),
      [&seed](std::uint64_t n) { seed = n; }, "seed of " + what + " (default 1)");
}

void add_threads_option(CLI::App& command, unsigned& threads, const std::string& what) {
  cli::add_integer(
      command, "--threads", 1, 1024,
      [&threads](std::uint64_t n) { threads = static_cast<unsigned>(n); },
      "threads" + what + " (default: all cores)");
}

void add_bakes_option(CLI::App& command, std::string& folder) {
  command
      .add_option("--bakes", folder,
                  "keep the baked assets in this folder, and take up those that a run of this very "
                  "build left there (default: bake all anew)")
      ->type_name("DIR");
}

void check_tolerance(const std::optional<double>& tolerance) {
  if (tolerance && *tolerance <= 0) throw CLI::ValidationError("--tolerance", "must be above 0");
}

void check_methods(const std::vector<std::string>& asked, const std::vector<std::string>& names) {
  for (const std::string& method : asked) {
    if (std::find(names.begin(), names.end(), method) != names.end()) continue;
    throw CLI::ValidationError("--method", fmt::format("'{}' will not do: write one of {}", method,
                                                       fmt::join(names, ", ")));
  }
}

}  // namespace spm::bench
