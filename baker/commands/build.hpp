// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <nlohmann/json.hpp>
#include <string>
#include <vector>

#include "baker/commands/build_request.hpp"
#include "baker/verify/verify.hpp"

namespace spm::baker {

/// What a build came to: the command-line contract's JSON object, and sentences for a person.
struct BuildReport {
  nlohmann::ordered_json json;
  std::vector<std::string> warnings;  ///< defaults that were taken, promises that are not kept
  std::vector<std::string> derived;   ///< what a device or a scene decided
  std::vector<std::string> notes;     ///< what was found in the mesh
};

/// Loads, bakes, verifies in memory and writes. Throws BakeError, with nothing written: among
/// others tolerance_not_met, whose message names the worst place and the cure.
[[nodiscard]] BuildReport run_build(const BuildRequest& request, const Progress& progress);

/// The report as a few lines for a person.
[[nodiscard]] std::string describe(const BuildReport& report);

}  // namespace spm::baker
