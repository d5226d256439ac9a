// SPDX-License-Identifier: GPL-3.0-or-later
#include "tests/stability/report/stability_text.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <iterator>

#include "common/base/units.hpp"
#include "tests/bench/base/machine.hpp"
#include "tests/stability/report/stability_targets.hpp"

namespace spm::stability {
namespace {

using Json = nlohmann::ordered_json;

const char* word_of(const Verdict& verdict) {
  if (verdict.good) return "good";
  return verdict.bad ? "bad" : "between";
}

char letter_of(const Verdict& verdict) {
  if (verdict.findings.popped) return 'P';
  if (verdict.good) return '+';
  return verdict.bad ? 'x' : '~';
}

Json case_json(const CaseRow& row) {
  const Findings& found = row.verdict.findings;
  Json json = {{"case", row.name},
               {"method", row.method},
               {"device", row.device},
               {"stable", row.verdict.good},
               {"energy_generated_j", found.generated_j},
               {"reason", row.verdict.reason},
               {"verdict", word_of(row.verdict)},
               {"degrees", row.degrees},
               {"fraction", row.fraction},
               {"stiffness_n_m", row.stiffness},
               {"seeds", row.seeds},
               {"good_seeds", row.good_seeds},
               {"popped", found.popped},
               {"ripple_n", found.ripple_n},
               {"ripple_m", found.ripple_m},
               {"energy_bound_j", found.generated_bound_j},
               {"penetration_m", found.penetration_m},
               {"settled_s", found.settled_s}};
  if (row.degrees == 6) json["torque"] = row.torque;
  return json;
}

Json border_json(const BorderRow& row) {
  return {{"case", row.name},       {"method", row.method},     {"device", row.device},
          {"degrees", row.degrees}, {"border_n_m", row.border}, {"flat_border_n_m", row.flat}};
}

Json energy_json(const EnergyRow& row) {
  return {{"case", row.name},
          {"device", row.device},
          {"stiffness_n_m", row.stiffness},
          {"stable", row.verdict.good},
          {"energy_generated_j", row.verdict.findings.generated_j},
          {"energy_bound_j", row.verdict.findings.generated_bound_j}};
}

Json theory_json(const TheoryRow& row) {
  return {{"criterion", row.criterion},
          {"kind", row.kind},
          {"settings", row.settings},
          {"expected", row.expected},
          {"measured", row.measured},
          {"unit", row.unit},
          {"off", row.off()}};
}

Json map_json(const StabilityMap& map) {
  Json json;
  json["method"] = map.method;
  json["device"] = map.device;
  json["stiffness_n_m"] = map.stiffnesses;
  json["damping_n_s_m"] = map.dampings;
  json["delay_ticks"] = map.delays;
  json["stable"] = map.stable;
  json["theory_border_n_m"] = map.theory;
  return json;
}

Json target_json(const TargetRow& row) {
  return {{"target", row.name},
          {"value", row.value},
          {"floor", row.floor},
          {"goal", row.goal},
          {"larger_is_better", row.larger_is_better},
          {"unit", row.unit},
          {"meets_floor", row.meets(row.floor)},
          {"meets_goal", row.meets(row.goal)},
          {"worst", row.worst}};
}

Json worst_json(const WorstTrace& worst) {
  Json json{{"method", worst.method}, {"trace", trace_name(worst)}};
  json["row"] = case_json(worst.row);
  return json;
}

Json list(const auto& rows, const auto& json_of) {
  Json json = Json::array();
  for (const auto& row : rows) json.push_back(json_of(row));
  return json;
}

/// Names in the order in which they first appear.
std::vector<std::string> methods_in(const StabilityReport& report) {
  std::vector<std::string> names;
  for (const CaseRow& row : report.cases) {
    if (std::find(names.begin(), names.end(), row.method) == names.end()) {
      names.push_back(row.method);
    }
  }
  return names;
}

void append_verdicts(const StabilityReport& report, double fraction,
                     const std::vector<std::string>& methods, std::string& text) {
  const auto out = std::back_inserter(text);
  fmt::format_to(out, "\nat {:g} of the profile's flat border\n  {:<28}", fraction, "");
  for (const std::string& method : methods) fmt::format_to(out, " {:>10}", method);
  text += "\n";
  for (const CaseTitle& tried : report.catalogue) {
    fmt::format_to(out, "  {:<28}", tried.name);
    for (const std::string& method : methods) {
      std::string letters;
      for (const CaseRow& row : report.cases) {
        if (row.name != tried.name || row.method != method || row.fraction != fraction) continue;
        letters += letter_of(row.verdict);
      }
      fmt::format_to(out, " {:>{}}", letters, std::max<std::size_t>(10, method.size()));
    }
    text += "\n";
  }
}

void append_borders(const StabilityReport& report, const std::vector<std::string>& methods,
                    std::string& text) {
  const auto out = std::back_inserter(text);
  for (const FlatBorder& flat : report.flats) {
    const auto here = [&flat](const BorderRow& row) { return row.device == flat.device; };
    if (std::none_of(report.borders.begin(), report.borders.end(), here)) continue;
    fmt::format_to(out, "\nlargest good stiffness on {}, N/m\n  {:<28}", flat.device, "");
    for (const std::string& method : methods) fmt::format_to(out, " {:>10}", method);
    text += "\n";
    for (const CaseTitle& tried : report.catalogue) {
      fmt::format_to(out, "  {:<28}", tried.name);
      for (const std::string& method : methods) {
        std::string words = "-";
        for (const BorderRow& row : report.borders) {
          if (!here(row) || row.name != tried.name || row.method != method) continue;
          words = fmt::format("{:.0f}", row.border);
        }
        fmt::format_to(out, " {:>{}}", words, std::max<std::size_t>(10, method.size()));
      }
      text += "\n";
    }
  }
}

void append_theory(const StabilityReport& report, std::string& text) {
  if (report.theory.empty()) return;
  const auto out = std::back_inserter(text);
  fmt::format_to(out, "\ntheory against the plant\n");
  for (const TheoryRow& row : report.theory) {
    fmt::format_to(out, "  {:<10} {:<28} {:<44} {:>12.6g} {:>12.6g} {:<6} {:>+8.3f} %\n", row.kind,
                   row.criterion, row.settings, row.expected, row.measured, row.unit,
                   100 * row.off());
  }
}

void append_loops(const StabilityReport& report, std::string& text) {
  if (report.loops.empty()) return;
  const auto out = std::back_inserter(text);
  fmt::format_to(out, "\nmost energy that a static loop of 10 mm gains, uJ\n");
  for (const LoopRow& row : report.loops) {
    fmt::format_to(out, "  {:<20} at {:<8} {:<24} {:>10.3f} (median {:.3f}) of {} loops\n",
                   row.object, format_quantity(row.tolerance, Quantity::length), row.method,
                   1e6 * row.gained_j, 1e6 * row.median_j, row.loops);
  }
}

void append_costs(const StabilityReport& report, std::string& text) {
  const auto out = std::back_inserter(text);
  if (!report.costs.empty()) {
    fmt::format_to(out, "\n  {:<24} {:>16} {:>12} {:>10} {:>10} {:>10}\n", "method",
                   "force error, %", "median, %", "lost, %", "mean us", "p99 us");
  }
  for (const CostRow& row : report.costs) {
    fmt::format_to(out, "  {:<24} {:>16.2f} {:>12.2f} {:>10.2f} {:>10.2f} {:>10.2f}\n", row.method,
                   100 * row.relative_error, 100 * row.median_error, 100 * row.lost_share,
                   row.mean_us, row.p99_us);
  }
}

void append_targets(const StabilityReport& report, std::string& text) {
  const auto out = std::back_inserter(text);
  fmt::format_to(out, "\n  {:<58} {:>12} {:>10} {:>10}  {}\n", "target", "measured", "floor",
                 "goal", "decided by");
  for (const TargetRow& row : targets_of(report)) {
    const char* met = row.meets(row.goal) ? "goal" : row.meets(row.floor) ? "floor" : "missed";
    fmt::format_to(out, "  {:<58} {:>12.5g} {:>10g} {:>10g}  {}: {}\n",
                   row.name + (row.unit.empty() ? "" : ", " + row.unit), row.value, row.floor,
                   row.goal, met, row.worst);
  }
}

}  // namespace

Json to_json(const StabilityReport& report, const StabilityPlan& plan) {
  Json json;
  json["made"] = bench::made_json();
  json["seed"] = plan.seed;
  json["fractions"] = plan.fractions;
  json["border_share"] = plan.border_share;
  json["catalogue"] = list(report.catalogue, [](const CaseTitle& row) {
    return Json{
        {"case", row.name}, {"theme", row.theme}, {"title", row.title}, {"degrees", row.degrees}};
  });
  json["flat_borders"] = list(report.flats, [](const FlatBorder& row) {
    return Json{{"device", row.device}, {"border_n_m", row.measured}, {"linear_n_m", row.linear}};
  });
  json["cases"] = list(report.cases, case_json);
  json["borders"] = list(report.borders, border_json);
  json["energies"] = list(report.energies, energy_json);
  json["theory"] = list(report.theory, theory_json);
  json["loops"] = list(report.loops, [](const LoopRow& row) {
    return Json{{"object", row.object},         {"method", row.method},
                {"tolerance_m", row.tolerance}, {"gained_j", row.gained_j},
                {"median_j", row.median_j},     {"loops", row.loops}};
  });
  json["maps"] = list(report.maps, map_json);
  json["costs"] = list(report.costs, [](const CostRow& row) {
    return Json{{"method", row.method},
                {"relative_error", row.relative_error},
                {"median_error", row.median_error},
                {"lost_share", row.lost_share},
                {"mean_us", row.mean_us},
                {"p99_us", row.p99_us}};
  });
  json["idle"] = list(report.idle, [](const IdleRow& row) {
    return Json{{"method", row.method}, {"device", row.device}, {"added_step_n", row.added_step_n}};
  });
  json["targets"] = list(targets_of(report), target_json);
  json["worst"] = list(report.worst, worst_json);
  json["failures"] = list(report.failures, [](const StabilityFailure& row) {
    return Json{{"case", row.name}, {"method", row.method}, {"reason", row.reason}};
  });
  return json;
}

std::string to_text(const StabilityReport& report, const StabilityPlan& plan) {
  std::string text = "a letter a profile, in the order";
  for (const FlatBorder& flat : report.flats) {
    text += fmt::format(" {} ({:.0f} N/m)", flat.device, flat.measured);
  }
  text += ": + good, ~ between, x bad, P popped through\n";
  const std::vector<std::string> methods = methods_in(report);
  for (const double fraction : plan.fractions) append_verdicts(report, fraction, methods, text);
  append_borders(report, methods, text);
  append_theory(report, text);
  append_loops(report, text);
  append_costs(report, text);
  append_targets(report, text);
  return text;
}

std::string trace_name(const WorstTrace& worst) { return worst.method + ".csv"; }

std::string to_csv(const WorstTrace& worst) {
  std::string text = "t,target,position,force,force_magnitude,hand_force,depth,energy,contact\n";
  const auto out = std::back_inserter(text);
  double energy = 0;
  for (const TraceTick& tick : worst.trace.ticks) {
    fmt::format_to(out, "{:.4f},{:.7g},{:.7g},{:.5g},{:.5g},{:.5g},{:.5g},{:.5g},{:d}\n", tick.time,
                   tick.target.dot(worst.normal), tick.position.dot(worst.normal),
                   tick.commanded.dot(worst.normal), tick.commanded.norm(),
                   tick.hand_force.dot(worst.normal), tick.depth, energy, tick.contact);
    // Energy that the device has generated up to the tick's start; the work of moving surfaces is
    // left out.
    energy += tick.work - tick.surface_work;
  }
  return text;
}

}  // namespace spm::stability
