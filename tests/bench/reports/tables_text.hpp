// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <nlohmann/json.hpp>
#include <string>

#include "tests/bench/reports/tables.hpp"

namespace spm::bench {

/// `made`, `rows`, `growth`, `failures`; times in us.
[[nodiscard]] nlohmann::ordered_json to_json(const TablesReport& report);

/// The three tables.
[[nodiscard]] std::string to_text(const TablesReport& report);

}  // namespace spm::bench
