// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <nlohmann/json.hpp>
#include <string>

#include "baker/report/report_page.hpp"
#include "baker/verify/verify.hpp"
#include "formats/asset/mapped_asset.hpp"

namespace spm::baker {

/// Refuses `--report` where the page is not there or the file could not be written, before the
/// work. Throws BakeError.
void check_report(const std::string& path, ReportPage page = ReportPage::asset);

/// Writes one page that shows an asset and what was found about it. `build` is the report of the
/// bake, null where there is none. Throws BakeError.
void write_report(const std::string& path, const MappedAsset& asset, const std::string& mesh_path,
                  const VerifyReport& report, const nlohmann::ordered_json& build);

}  // namespace spm::baker
