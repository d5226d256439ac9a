// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <nlohmann/json_fwd.hpp>
#include <string>
#include <vector>

#include "baker/surface/outer_surface.hpp"

namespace spm::baker {

/// Adds the capped holes to the object of a report: `caps`, largest first and at most 100, with
/// `caps_total` and `caps_area_mm2` of all.
void add_caps_json(const std::vector<CappedHole>& holes, nlohmann::ordered_json& report);

/// The same as a line for a person; empty where nothing was capped.
[[nodiscard]] std::string caps_text(const nlohmann::ordered_json& report);

}  // namespace spm::baker
