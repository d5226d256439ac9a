// SPDX-License-Identifier: GPL-3.0-or-later
#include "tests/bench/commands.hpp"

#include <fmt/format.h>

#include <algorithm>

namespace spm::bench {

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
