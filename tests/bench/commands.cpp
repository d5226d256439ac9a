// SPDX-License-Identifier: GPL-3.0-or-later
#include "tests/bench/commands.hpp"

#include <fmt/format.h>

#include <algorithm>

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
