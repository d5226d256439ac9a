// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <nlohmann/json.hpp>
#include <string>

#include "tests/bench/reports/times.hpp"

namespace spm::bench {

/// `made`, `meshes`, `rows`, `probe_rows`, `ratios`, `failures`; lengths in um, times in ns.
[[nodiscard]] nlohmann::ordered_json to_json(const TimesReport& report, const TimesPlan& plan);

/// One table per mesh.
[[nodiscard]] std::string to_text(const TimesReport& report);

}  // namespace spm::bench
