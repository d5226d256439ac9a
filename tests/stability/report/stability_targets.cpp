// SPDX-License-Identifier: GPL-3.0-or-later
#include "tests/stability/report/stability_targets.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <map>

#include "common/base/units.hpp"

namespace spm::stability {
namespace {

constexpr double gentle_fraction = 0.6;  ///< of the flat border: here the default must hold

/// Keeps the worst value shown to it, and where that came from.
class Worst {
 public:
  Worst(std::string name, std::string unit, double floor, double goal, bool larger_is_better) {
    row_.name = std::move(name);
    row_.unit = std::move(unit);
    row_.floor = floor;
    row_.goal = goal;
    row_.larger_is_better = larger_is_better;
  }
  void show(double value, const std::string& what) {
    const bool worse = row_.larger_is_better ? value < row_.value : value > row_.value;
    if (seen_ && !worse) return;
    seen_ = true;
    row_.value = value;
    row_.worst = what;
  }
  void append_to(std::vector<TargetRow>& rows) const {
    if (seen_) rows.push_back(row_);
  }

 private:
  TargetRow row_;
  bool seen_ = false;
};

bool is_gentle_default(const CaseRow& row) {
  return row.method == "default" && row.fraction == gentle_fraction;
}

void add_theory(const StabilityReport& report, std::vector<TargetRow>& rows) {
  Worst eigenvalue("linear border off the exact eigenvalue", "share", 0.01, 0.002, false);
  Worst passivity("passivity formulas, each by its adversary", "share", 0.02, 0.005, false);
  for (const TheoryRow& row : report.theory) {
    const std::string what = row.criterion + ", " + row.settings;
    if (row.kind == "stability") eigenvalue.show(std::abs(row.off()), what);
    if (row.kind == "passivity") passivity.show(std::abs(row.off()), what);
  }
  eigenvalue.append_to(rows);
  passivity.append_to(rows);
}

/// The failed cases, with devices: `delay-4-ticks (falcon, touch), encoder-100um (low)`.
std::string list_of(const std::map<std::string, std::vector<std::string>>& failed,
                    const std::vector<std::string>& order, bool with_devices) {
  std::string text;
  for (const std::string& name : order) {
    const auto found = failed.find(name);
    if (found == failed.end()) continue;
    if (!text.empty()) text += ", ";
    text += name;
    if (with_devices) text += fmt::format(" ({})", fmt::join(found->second, ", "));
  }
  return text.empty() ? "none failed" : text;
}

/// A row's device, in words.
std::string device_of(const CaseRow& row) {
  return row.degrees == 6 && !row.torque ? row.device + " without torque" : row.device;
}

/// Share of good results at 0.6 of the tools that turn, on devices with torque and without.
void add_tools(const StabilityReport& report, std::vector<TargetRow>& rows) {
  std::string failed;
  double good = 0, all = 0;
  for (const CaseRow& row : report.cases) {
    if (!is_gentle_default(row) || row.degrees != 6) continue;
    all += 1;
    good += row.verdict.good ? 1 : 0;
    if (row.verdict.good) continue;
    failed += (failed.empty() ? "" : ", ") + row.name + " (" + device_of(row) + ")";
  }
  if (!(all > 0)) return;
  rows.push_back({"tools of six degrees good at 0.6, with torque and without", good / all, 0.95, 1,
                  true, "share", failed.empty() ? "none failed" : failed});
}

/// Shares of good results at 0.6: of all pairs of case and profile, and of the cases that are good
/// on every profile.
void add_shares(const StabilityReport& report, std::vector<TargetRow>& rows) {
  std::vector<std::string> tried;
  std::map<std::string, std::vector<std::string>> failed;
  double good = 0, all = 0;
  for (const CaseRow& row : report.cases) {
    if (!is_gentle_default(row)) continue;
    all += 1;
    if (std::find(tried.begin(), tried.end(), row.name) == tried.end()) tried.push_back(row.name);
    if (row.verdict.good) {
      good += 1;
    } else {
      failed[row.name].push_back(device_of(row));
    }
  }
  if (!(all > 0)) return;
  const auto cases = static_cast<double>(tried.size());
  rows.push_back({"default good at 0.6, of cases and profiles", good / all, 0.9, 1, true, "share",
                  list_of(failed, tried, true)});
  rows.push_back({"default good at 0.6 on every profile, of cases",
                  (cases - static_cast<double>(failed.size())) / cases, 0.9, 1, true, "share",
                  list_of(failed, tried, false)});
}

void add_energy(const StabilityReport& report, std::vector<TargetRow>& rows) {
  Worst good("net energy of the default at 0.6, of its bound, good runs", "times", 2, 1, false);
  Worst all("net energy of the default at 0.6, of its bound, all runs", "times", 2, 1, false);
  for (const CaseRow& row : report.cases) {
    const Findings& found = row.verdict.findings;
    if (!is_gentle_default(row) || !(found.generated_bound_j > 0)) continue;
    const double share = found.generated_j / found.generated_bound_j;
    if (row.verdict.good) good.show(share, row.name + ", " + row.device);
    all.show(share, row.name + ", " + row.device);
  }
  good.append_to(rows);
  all.append_to(rows);
}

/// The floor is twice the bound of the run with the most energy.
void add_fixed_energy(const StabilityReport& report, std::vector<TargetRow>& rows) {
  const EnergyRow* most = nullptr;
  for (const EnergyRow& row : report.energies) {
    const double generated = row.verdict.findings.generated_j;
    if (most == nullptr || generated > most->verdict.findings.generated_j) most = &row;
  }
  if (most == nullptr) return;
  const Findings& found = most->verdict.findings;
  const char* run = most->verdict.good ? "a good run" : most->verdict.bad ? "a bad run" : "between";
  rows.push_back(
      {"net energy of the default at 1 N/mm", found.generated_j, 2 * found.generated_bound_j, 1e-3,
       false, "J",
       fmt::format("{}, {}: {}; the floor is twice its bound", most->name, most->device, run)});
}

/// The border of another method in the same case on the same profile; null where there is none.
const BorderRow* beside(const StabilityReport& report, const BorderRow& row,
                        const std::string& method) {
  for (const BorderRow& other : report.borders) {
    if (other.method == method && other.name == row.name && other.device == row.device) {
      return &other;
    }
  }
  return nullptr;
}

bool is_sphere_between_walls(const std::string& name) {
  return name.starts_with("sphere-groove") || name.starts_with("sphere-in-groove") ||
         name.starts_with("sphere-corner") || name.starts_with("sphere-in-corner");
}

/// The default's border over that of the exact penalty. Where the exact penalty fails even at the
/// lowest stiffness tried, that stiffness is the divisor: the true ratio is at least as large.
void show_sphere(const StabilityReport& report, const BorderRow& row, Worst& sphere) {
  const BorderRow* exact = beside(report, row, "exact-penalty");
  if (!is_sphere_between_walls(row.name) || exact == nullptr) return;
  const double least = min_border_share * row.flat;
  const std::string what = row.name + ", " + row.device;
  if (exact->border > 0) {
    sphere.show(row.border / exact->border, what);
  } else {
    sphere.show(row.border / least,
                fmt::format("{}: at least that, the exact penalty fails at the least stiffness "
                            "tried ({:.0f} N/m)",
                            what, least));
  }
}

void add_borders(const StabilityReport& report, std::vector<TargetRow>& rows) {
  Worst worst("worst case's border over the flat border, default", "times", 0.6, 0.9, true);
  Worst sphere("sphere in groove and corner: default over exact penalty", "times", 3, 4.5, true);
  Worst stabilization("border with one stabilizer over without", "times", 0.8, 1, true);
  Worst product("border of the default over bare proxy, every profile", "times", 0.8, 1, true);
  for (const BorderRow& row : report.borders) {
    const std::string what = row.name + ", " + row.device;
    const bool is_default = row.method == "default";
    if (is_default) {
      worst.show(row.border / row.flat, what);
      show_sphere(report, row, sphere);
    }
    const std::size_t plus = row.method.find('+');
    if (!is_default && plus == std::string::npos) continue;
    const BorderRow* bare = beside(report, row, is_default ? "proxy" : row.method.substr(0, plus));
    if (bare == nullptr || !(bare->border > 0)) continue;
    const double ratio = row.border / bare->border;
    if (is_default) {
      product.show(ratio, what);
    } else {
      stabilization.show(ratio, row.method + ", " + what);
    }
  }
  worst.append_to(rows);
  sphere.append_to(rows);
  stabilization.append_to(rows);
  product.append_to(rows);
}

void add_loops(const StabilityReport& report, std::vector<TargetRow>& rows) {
  Worst gained("static loop energy of spm on real assets", "J", 10e-6, 1e-6, false);
  for (const LoopRow& row : report.loops) {
    if (row.method != "spm") continue;
    gained.show(row.gained_j,
                row.object + ", baked to " + format_quantity(row.tolerance, Quantity::length));
  }
  gained.append_to(rows);
}

void add_costs(const StabilityReport& report, std::vector<TargetRow>& rows) {
  Worst idle("stabilizers idle on a gentle press: added force step", "N", 0.1, 0.03, false);
  for (const IdleRow& row : report.idle) {
    idle.show(row.added_step_n, row.method + ", " + row.device);
  }
  idle.append_to(rows);
  const auto mean_of = [&report](const std::string& method) {
    for (const CostRow& row : report.costs) {
      if (row.method == method) return row.mean_us;
    }
    return std::nan("");
  };
  const double added = mean_of("default") - mean_of("proxy");
  if (std::isnan(added)) return;
  rows.push_back({"cost of the default's stabilizers in the tick", added, 1, 0.2, false, "us",
                  "mean of the slide's ticks, default less proxy"});
}

}  // namespace

std::vector<TargetRow> targets_of(const StabilityReport& report) {
  std::vector<TargetRow> rows;
  add_theory(report, rows);
  add_shares(report, rows);
  add_tools(report, rows);
  add_borders(report, rows);
  add_energy(report, rows);
  add_fixed_energy(report, rows);
  add_loops(report, rows);
  add_costs(report, rows);
  return rows;
}

}  // namespace spm::stability
