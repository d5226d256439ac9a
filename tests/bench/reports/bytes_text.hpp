// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <nlohmann/json.hpp>
#include <string>

#include "tests/bench/reports/bytes.hpp"

namespace spm::bench {

/// The rows as `--json` gives them: lengths in um and angles in degrees where the key says so.
[[nodiscard]] nlohmann::ordered_json to_json(const BytesReport& report);

/// The rows as tables for a person, one table per model.
[[nodiscard]] std::string to_text(const BytesReport& report);

}  // namespace spm::bench
