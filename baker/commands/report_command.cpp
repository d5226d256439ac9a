// SPDX-License-Identifier: GPL-3.0-or-later
#include "baker/commands/report_command.hpp"

#include "baker/base/bake_error.hpp"
#include "baker/commands/info_json.hpp"
#include "baker/commands/verify_text.hpp"
#include "baker/report/report_page.hpp"
#include "baker/report/report_surface.hpp"
#include "baker/verify/verify_pictures.hpp"
#include "formats/files/output_file.hpp"

namespace spm::baker {

namespace {

using Json = nlohmann::ordered_json;

void hold(const Result<void>& done) {
  if (!done) throw BakeError(done.error().code, done.error().message);
}

}  // namespace

void check_report(const std::string& path) {
  hold(check_output_path(path));
  static_cast<void>(built_page());
}

void write_report(const std::string& path, const MappedAsset& asset, const std::string& mesh_path,
                  const VerifyReport& report, const Json& build) {
  const AssetMetadata& metadata = asset.metadata();
  Json data;
  data["kind"] = build.is_null() ? "verify" : "build";
  data["asset"] = to_json(asset, {});
  data["verify"] = to_json(report);
  data["build"] = build;
  data["surface"] =
      surface_json(mesh_of_asset(metadata, mesh_path), asset.view(), metadata, report);
  data["pictures"] = Json::array();
  for (const NamedPicture& made : error_pictures(asset.view(), metadata, mesh_path, report)) {
    data["pictures"].push_back({{"name", made.name}, {"image", data_url(made.picture)}});
  }
  hold(write_file(path, filled_page(built_page(), data)));
}

}  // namespace spm::baker
