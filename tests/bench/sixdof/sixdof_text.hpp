// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <nlohmann/json.hpp>
#include <string>

#include "tests/bench/sixdof/sixdof.hpp"

namespace spm::bench {

[[nodiscard]] nlohmann::ordered_json to_json(const SixdofReport& report);
[[nodiscard]] std::string to_text(const SixdofReport& report);

}  // namespace spm::bench
