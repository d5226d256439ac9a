// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <nlohmann/json_fwd.hpp>
#include <string>
#include <vector>

#include "baker/mesh/mesh.hpp"

namespace spm::baker {

/// Adds the holes that lids close to the object of a report: `lids`, largest first and at most 100,
/// with `lids_total` and `lids_area_mm2` of all.
void add_lids_json(const std::vector<Hole>& holes, nlohmann::ordered_json& report);

/// The same as a line for a person; empty where there are none.
[[nodiscard]] std::string lids_text(const nlohmann::ordered_json& report);

}  // namespace spm::baker
