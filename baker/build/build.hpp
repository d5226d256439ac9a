// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <nlohmann/json.hpp>
#include <string>
#include <vector>

#include "baker/build/build_request.hpp"
#include "baker/options/bake_report.hpp"
#include "baker/verify/verify.hpp"
#include "common/asset/asset_view.hpp"

namespace spm::baker {

/// The result of a build: the JSON object of the command-line contract, and sentences for a person.
// NOLINTNEXTLINE(bugprone-exception-escape): a JSON value allocates while it is destroyed.
struct BuildReport {
  nlohmann::ordered_json json;
  std::vector<std::string> warnings;  ///< defaults that were used, promises that are not kept
  std::vector<std::string> derived;   ///< what a device or a scene decided
  std::vector<std::string> notes;     ///< findings about the mesh
};

/// Whether an output could be written, in a folder that would be made first where it is missing.
[[nodiscard]] Result<void> check_new_output(const std::string& output);

/// Makes the folder in which an output is to lie, where it is missing. Throws BakeError.
void make_folder_of(const std::string& output);

/// Refuses an output that could not be written or is the mesh itself. Throws BakeError.
void check_paths(const BuildRequest& request);

/// Loads, bakes, verifies in memory and writes. Throws BakeError, with nothing written. Among
/// others tolerance_not_met, whose message names the worst place and what to do.
[[nodiscard]] BuildReport run_build(const BuildRequest& request, const Progress& progress);

/// From what places are answered, as reports of bakes and files have it, and for a person.
void add_answers(const AssetView& view, nlohmann::ordered_json& json);
[[nodiscard]] std::string answers_text(const nlohmann::ordered_json& json);

/// The report as a few lines for a person.
[[nodiscard]] std::string describe(const BuildReport& report);

}  // namespace spm::baker
