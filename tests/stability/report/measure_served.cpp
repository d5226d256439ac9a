// SPDX-License-Identifier: GPL-3.0-or-later

// What `spm-servo run --asset` holds on each simulated profile without any other option: the cases
// on the teeth, and those of the catalogue that an asset alone can have. Prints JSON.
//
// Usage: measure_served [--quick | --only-teeth]. --quick tries four places and none of the
// catalogue. SPM_SHARED names the folder of the meshes.

#include <fmt/format.h>

#include <cstdio>
#include <cstring>
#include <nlohmann/json.hpp>

#include "baker/base/bake_error.hpp"
#include "tests/stability/catalogue/catalogue.hpp"
#include "tests/stability/objects/prepared_object.hpp"
#include "tests/stability/report/served_default.hpp"

namespace spm::stability {
namespace {

constexpr int teeth_places = 24, quick_places = 4;

nlohmann::ordered_json settings_json() {
  auto list = nlohmann::ordered_json::array();
  for (const servo::SimProfile& profile : servo::sim_profiles) {
    const servo::ForceChoice choice = served_by_default(profile, 0);
    const ForceSettings& force = choice.scene.objects.front().force;
    const StabilizationSettings& loop = choice.scene.stabilization;
    list.push_back({{"device", profile.name},
                    {"method", servo::to_string(force.method)},
                    {"stiffness_n_m", force.stiffness},
                    {"probe_radius_m", force.probe_radius},
                    {"damping_share", loop.damping_share},
                    {"passivity", loop.passivity},
                    {"delay_ticks", loop.delay_ticks},
                    {"lag_s", loop.lag},
                    {"device_mass_kg", loop.device_mass}});
  }
  return list;
}

nlohmann::ordered_json rows_json(const std::vector<ServedRow>& rows) {
  auto list = nlohmann::ordered_json::array();
  for (const ServedRow& row : rows) {
    const CaseVerdict& found = row.verdict;
    list.push_back({{"case", row.name},
                    {"device", row.device},
                    {"start_m", {row.place.x(), row.place.y(), row.place.z()}},
                    {"probe_radius_m", row.probe_radius},
                    {"stiffness_n_m", row.stiffness},
                    {"seeds", found.seeds},
                    {"good_seeds", found.good_seeds},
                    {"stable", row.failure.empty() && found.good()},
                    {"bad", row.failure.empty() && found.worst.bad},
                    {"within_energy", found.worst.within_energy},
                    {"end_aside_m", row.end.aside},
                    {"end_depth_m", row.end.depth},
                    {"ripple_n", found.worst.findings.ripple_n},
                    {"popped", found.worst.findings.popped},
                    {"reason", row.failure.empty() ? found.worst.reason : row.failure}});
  }
  return list;
}

void measure(bool quick, bool only_teeth) {
  std::vector<StabilityCase> of_catalogue;
  auto left_out = nlohmann::ordered_json::array();
  for (const StabilityCase& tried : whole_catalogue()) {
    std::string reason = why_not_by_default(tried);
    if (reason.empty()) reason = why_unprepared(tried);
    if (reason.empty() && !quick && !only_teeth) of_catalogue.push_back(tried);
    if (!reason.empty()) left_out.push_back({{"case", tried.name}, {"reason", reason}});
  }
  const nlohmann::ordered_json json{
      {"settings", settings_json()},
      {"teeth", rows_json(serve_all(teeth_cases(quick ? quick_places : teeth_places)))},
      {"catalogue", rows_json(serve_all(of_catalogue))},
      {"left_out", std::move(left_out)}};
  fmt::print("{}\n", json.dump());
}

}  // namespace
}  // namespace spm::stability

int main(int count, char** words) {
  const bool quick = count == 2 && std::strcmp(words[1], "--quick") == 0;
  const bool only_teeth = count == 2 && std::strcmp(words[1], "--only-teeth") == 0;
  if (count > 1 && !quick && !only_teeth) {
    fmt::print(stderr, "usage: measure_served [--quick | --only-teeth]\n");
    return 1;
  }
  try {
    spm::stability::measure(quick, only_teeth);
    return 0;
  } catch (const spm::baker::BakeError& problem) {
    fmt::print(stderr, "measure_served: {}\n", problem.what());
    return 2;
  }
}
