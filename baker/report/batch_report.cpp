// SPDX-License-Identifier: GPL-3.0-or-later
#include "baker/report/batch_report.hpp"

#include <memory>

#include "baker/report/report_page.hpp"
#include "baker/verify/render.hpp"
#include "common/contour/contour_mesh.hpp"
#include "formats/asset/mapped_asset.hpp"

namespace spm::baker {

using Json = nlohmann::ordered_json;

namespace {

constexpr std::uint32_t thumbnail_side = 96;
constexpr int thumbnail_cells = 64;  ///< along the longest edge, of the surface's grid
constexpr double um_per_m = 1e6;

/// A value deep in a line, null where it is not there.
template <class... Keys>
Json value_at(const Json& line, const Keys&... keys) {
  const Json* at = &line;
  for (const char* key : {keys...}) {
    if (!at->is_object() || !at->contains(key)) return nullptr;
    at = &(*at)[key];
  }
  return *at;
}

Json row_of(const BatchLine& asset, bool with_picture) {
  const Json& line = asset.line;
  Json row = {{"name", value_at(line, "name")},
              {"ok", value_at(line, "ok")},
              {"code", value_at(line, "exit_code")},
              {"error", value_at(line, "error")},
              {"output", value_at(line, "output")},
              {"triangles", value_at(line, "mesh", "triangles")},
              {"closed", value_at(line, "mesh", "closed")},
              {"bytes", value_at(line, "bytes")},
              {"tolerance_um", value_at(line, "tolerance_um")},
              {"tolerance_met", value_at(line, "tolerance_met")},
              {"measured_um", value_at(line, "error_um", "max")},
              {"seconds", value_at(line, "seconds", "total")},
              {"memory", value_at(line, "peak_rss_bytes")},
              {"cache", value_at(line, "cache")},
              {"cache_reason", value_at(line, "cache_reason")},
              {"notes", value_at(line, "notes")}};
  if (line.value("ok", Json()) != true) return row;
  const auto opened = MappedAsset::open(asset.file);
  if (!opened) {
    row["notes"] = Json::array({opened.error().message});
    return row;
  }
  const AssetMetadata& metadata = (*opened)->metadata();
  row["certified_um"] = metadata.certified ? Json(*metadata.certified * um_per_m) : Json();
  if (with_picture) {
    row["picture"] = data_url(thumbnail((*opened)->view(), metadata, thumbnail_side));
  }
  return row;
}

}  // namespace

Picture thumbnail(const AssetView& asset, const AssetMetadata& metadata, std::uint32_t side) {
  const Vector3 toward = Vector3(0.5, 0.42, 0.85).normalized();
  return render(caster_of(contour_mesh(asset, thumbnail_cells)),
                whole_of(metadata.box_min, metadata.box_max, toward), side);
}

Json batch_json(const std::string& manifest, const std::vector<BatchLine>& lines) {
  Json json = {{"kind", "batch"}, {"manifest", manifest}, {"assets", Json::array()}};
  std::size_t pictures = 0;
  for (const BatchLine& line : lines) {
    json["assets"].push_back(row_of(line, pictures < most_thumbnails));
    pictures += json["assets"].back().contains("picture") ? 1 : 0;
  }
  return json;
}

}  // namespace spm::baker
