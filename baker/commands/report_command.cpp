// SPDX-License-Identifier: GPL-3.0-or-later
#include "baker/commands/report_command.hpp"

#include <algorithm>
#include <map>
#include <vector>

#include "baker/base/bake_error.hpp"
#include "baker/commands/info_json.hpp"
#include "baker/commands/verify_text.hpp"
#include "baker/pictures/picture.hpp"
#include "baker/report/report_page.hpp"
#include "baker/report/report_surface.hpp"
#include "baker/verify/verify_pictures.hpp"
#include "formats/files/output_file.hpp"

namespace spm::baker {

namespace {

using Json = nlohmann::ordered_json;

constexpr std::size_t most_maps = 8;     ///< in the picture of the maps
constexpr std::uint32_t map_side = 160;  ///< pixels, of each

void hold(const Result<void>& done) {
  if (!done) throw BakeError(done.error().code, done.error().message);
}

/// The maps of the planes that have the most, seen along each plane's normal; of no size
/// where there are none.
Picture maps_picture(const AssetView& view) {
  std::map<std::size_t, std::size_t> samples;
  for (const DistanceMap& map : view.maps)
    samples[map.plane] += std::size_t{map.columns} * map.rows;
  for (const HeightChart& chart : view.charts)
    samples[chart.plane] += std::size_t{chart.columns} * chart.rows;
  std::vector<std::size_t> planes;
  planes.reserve(samples.size());
  for (const auto& [plane, count] : samples) planes.push_back(plane);
  std::stable_sort(planes.begin(), planes.end(),
                   [&](std::size_t a, std::size_t b) { return samples[a] > samples[b]; });
  planes.resize(std::min(planes.size(), most_maps));
  std::vector<Picture> pictures;
  pictures.reserve(planes.size());
  for (const std::size_t plane : planes) pictures.push_back(plane_picture(view, plane, map_side));
  return pictures.empty() ? Picture{} : contact_sheet(pictures, map_side);
}

}  // namespace

void check_report(const std::string& path, ReportPage page) {
  hold(check_output_path(path));
  static_cast<void>(built_page(page));
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
  if (const Picture maps = maps_picture(asset.view()); maps.width > 0) {
    data["pictures"].push_back({{"name", "maps.png"}, {"image", data_url(maps)}});
  }
  for (const NamedPicture& made : error_pictures(asset.view(), metadata, mesh_path, report)) {
    data["pictures"].push_back({{"name", made.name}, {"image", data_url(made.picture)}});
  }
  hold(write_file(path, filled_page(built_page(ReportPage::asset), data)));
}

}  // namespace spm::baker
