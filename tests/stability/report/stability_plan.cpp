// SPDX-License-Identifier: GPL-3.0-or-later
#include <algorithm>

#include "tests/stability/catalogue/catalogue.hpp"
#include "tests/stability/report/stability_report.hpp"
#include "tests/stability/sixdof/sixdof_case.hpp"

namespace spm::stability {

std::vector<std::string> case_names() {
  std::vector<std::string> names;
  for (const StabilityCase& one : whole_catalogue()) names.push_back(one.name);
  for (const SixdofCase& one : sixdof_catalogue()) names.push_back(one.name);
  return names;
}

std::vector<std::string> method_names() {
  std::vector<std::string> names;
  for (const Contender& one : all_contenders()) names.push_back(name_of(one));
  return names;
}

std::vector<std::string> device_names() {
  std::vector<std::string> names;
  for (const servo::SimProfile& one : servo::sim_profiles) names.emplace_back(one.name);
  return names;
}

std::vector<std::string> quick_cases() {
  return {"flat-wall",
          "delay-4-ticks",
          "encoder-100um",
          "tap-at-500-mm-s",
          "noisy-flat-wall",
          "plate-200um-at-50-mm-s",
          "plate-200um-at-1000-mm-s",
          "sphere-on-slot",
          "sphere-in-groove-60",
          "sphere-in-corner",
          "friction-at-rest",
          "texture-at-rest",
          "object-into-hand"};
}

void make_quick(StabilityPlan& plan) {
  if (plan.devices.empty()) plan.devices = {std::string(servo::sim_profiles.front().name)};
  if (plan.cases.empty()) plan.cases = quick_cases();
  plan.min_tolerance = 100e-6;
  plan.borders = plan.loops = plan.costs = false;
  plan.max_seeds = 1;
  plan.theory_loops = 12;
  plan.map.methods = {"proxy", "default"};
  plan.map.stiffnesses = 10;
  plan.map.dampings = {0, 2, 4, 6};
  plan.map.delays = {0, 1, 2};
}

const std::vector<std::string>& part_names() {
  static const std::vector<std::string> names{"borders", "theory", "loops", "maps", "costs"};
  return names;
}

void keep_parts(StabilityPlan& plan, const std::vector<std::string>& parts) {
  if (parts.empty()) return;
  const auto is_kept = [&parts](const char* part) {
    return std::find(parts.begin(), parts.end(), part) != parts.end();
  };
  plan.borders = is_kept("borders");
  plan.theory = is_kept("theory");
  plan.loops = is_kept("loops");
  plan.maps = is_kept("maps");
  plan.costs = is_kept("costs");
}

}  // namespace spm::stability
