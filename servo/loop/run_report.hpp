// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <nlohmann/json.hpp>
#include <string>

#include "servo/loop/run.hpp"

namespace spm::servo {

/// Percentiles as the contract names them: `p50`, `p99`, `p999`, `max`.
[[nodiscard]] nlohmann::ordered_json percentiles_json(const Summary& summary);

/// Adds what the forces were computed with: method and stiffness of an asset, or the scene's
/// `objects`.
void add_forces(nlohmann::ordered_json& report, const ForceChoice& choice);

/// The object that `spm-servo run --json` prints.
[[nodiscard]] nlohmann::ordered_json to_json(const RunReport& report);

/// The same as text for a person, several lines.
[[nodiscard]] std::string to_text(const RunReport& report);

}  // namespace spm::servo
