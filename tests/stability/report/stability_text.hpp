// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <nlohmann/json.hpp>
#include <string>

#include "tests/stability/report/stability_report.hpp"

namespace spm::stability {

/// `made`, `catalogue`, `flat_borders`, `cases`, `borders`, `energies`, `theory`, `loops`,
/// `maps`, `costs`, `idle`, `targets`, `worst`, `failures`; SI units.
[[nodiscard]] nlohmann::ordered_json to_json(const StabilityReport& report,
                                             const StabilityPlan& plan);

/// Readable text: cases against methods, one letter per profile.
[[nodiscard]] std::string to_text(const StabilityReport& report, const StabilityPlan& plan);

/// The name of the file to which a worst case's run is written: METHOD.csv.
[[nodiscard]] std::string trace_name(const WorstTrace& worst);

/// The run of a worst case as CSV, one line per tick.
[[nodiscard]] std::string to_csv(const WorstTrace& worst);

}  // namespace spm::stability
