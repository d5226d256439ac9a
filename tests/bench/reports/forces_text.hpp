// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <nlohmann/json.hpp>
#include <string>

#include "tests/bench/reports/forces.hpp"

namespace spm::bench {

/// `made`, the settings, `paths`, `rows`, `failures`; forces in N.
[[nodiscard]] nlohmann::ordered_json to_json(const ForcesReport& report, const ForcesPlan& plan);

/// One table per path.
[[nodiscard]] std::string to_text(const ForcesReport& report);

/// A path's forces as CSV, a line a tick: time, place, distance, what is judged, then force and
/// direction of the exact penalty and of each method.
[[nodiscard]] std::string to_csv(const ForceTrace& trace, const ForcesPlan& plan);

}  // namespace spm::bench
