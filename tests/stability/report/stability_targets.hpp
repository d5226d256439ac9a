// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "tests/stability/report/stability_report.hpp"

namespace spm::stability {

/// A figure that the laboratory must reach, with its floor and its goal.
struct TargetRow {
  std::string name;
  double value = 0;
  double floor = 0, goal = 0;
  bool larger_is_better = true;
  std::string unit;
  std::string worst;  ///< which case, method or device decides it

  [[nodiscard]] bool meets(double wanted) const noexcept {
    return larger_is_better ? value >= wanted : value <= wanted;
  }
};

/// The targets that can be computed from the report's rows; targets whose rows were left out are
/// missing.
[[nodiscard]] std::vector<TargetRow> targets_of(const StabilityReport& report);

}  // namespace spm::stability
