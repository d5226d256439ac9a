// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <nlohmann/json.hpp>
#include <string>
#include <vector>

#include "baker/verify/verify.hpp"

namespace spm::baker {

/// The verdict in words, with counts, tolerance and seed, such as "kept: 0 of 1,000,000 places
/// ...".
[[nodiscard]] std::string verdict_of(const VerifyReport& report);

/// All that a verification found, for a person; the verdict is the last line.
[[nodiscard]] std::string describe(const VerifyReport& report);

/// The same for a program.
[[nodiscard]] nlohmann::ordered_json to_json(const VerifyReport& report);

/// The worst places as a PLY of coloured points, text: position in metres, error in um (-1 where
/// there is no answer), the finding's number.
[[nodiscard]] std::string to_ply(const std::vector<WorstPlace>& places);

}  // namespace spm::baker
