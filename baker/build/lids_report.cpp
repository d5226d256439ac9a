// SPDX-License-Identifier: GPL-3.0-or-later
#include "baker/build/lids_report.hpp"

#include <fmt/format.h>

#include <cmath>
#include <cstddef>
#include <nlohmann/json.hpp>

namespace spm::baker {
namespace {

using Json = nlohmann::ordered_json;

/// Most entries of a report. A scan may have thousands of holes, of which the largest matter.
constexpr std::size_t max_entries = 100;
constexpr double mm2_of_m2 = 1e6;

}  // namespace

void add_lids_json(const std::vector<Hole>& holes, Json& report) {
  Json& listed = report["lids"] = Json::array();
  double area = 0;
  for (const Hole& hole : holes) {
    area += hole.area;
    if (listed.size() >= max_entries) continue;
    listed.push_back({{"place", {hole.middle.x(), hole.middle.y(), hole.middle.z()}},
                      {"area_mm2", hole.area * mm2_of_m2},
                      {"edges", hole.edges}});
  }
  report["lids_total"] = holes.size();
  report["lids_area_mm2"] = area * mm2_of_m2;
}

std::string lids_text(const Json& report) {
  const auto total = report["lids_total"].get<std::size_t>();
  if (total == 0) return {};
  const Json& largest = report["lids"].front();
  const auto millimetres = [&](std::size_t axis) {
    // To the nanometre: what rounding leaves of a 0 is not a place.
    return std::round(1e9 * largest["place"][axis].get<double>()) / 1e6 + 0.0;
  };
  const std::string place =
      fmt::format("({:.4g}, {:.4g}, {:.4g}) mm", millimetres(0), millimetres(1), millimetres(2));
  const auto area = report["lids_area_mm2"].get<double>();
  if (total == 1) return fmt::format("lids     1 hole closed, {:.3g} mm2 at {}\n", area, place);
  return fmt::format("lids     {} holes closed, {:.3g} mm2 in all; the largest {:.3g} mm2 at {}\n",
                     total, area, largest["area_mm2"].get<double>(), place);
}

}  // namespace spm::baker
