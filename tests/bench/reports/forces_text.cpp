// SPDX-License-Identifier: GPL-3.0-or-later
#include "tests/bench/reports/forces_text.hpp"

#include <fmt/format.h>

#include <iterator>
#include <numbers>

#include "common/base/units.hpp"
#include "tests/bench/base/machine.hpp"
#include "tests/bench/reports/row_text.hpp"

namespace spm::bench {
namespace {

using Json = nlohmann::ordered_json;

constexpr double degrees = 180 / std::numbers::pi;
constexpr double tick_seconds = 1e-3;

Json quantiles_json(const Quantiles& values, double unit = 1) {
  return {{"p50", values.p50 * unit},
          {"p99", values.p99 * unit},
          {"p999", values.p999 * unit},
          {"max", values.max * unit},
          {"ticks", values.count}};
}

double share_of(std::uint64_t part, std::uint64_t whole) {
  return whole > 0 ? static_cast<double>(part) / static_cast<double>(whole) : 0;
}

Json path_json(const PathRow& row) {
  const JudgedTicks& judged = row.judged;
  Json json;
  json["mesh"] = row.model;
  json["path"] = row.path;
  json["probe_radius_m"] = row.radius;
  json["ticks"] = row.ticks;
  json["contact_ticks"] = judged.contacts;
  json["judged_ticks"] = judged.judged;
  json["left_out"] = {{"deeper_than_band", share_of(judged.deep, judged.contacts)},
                      {"direction_contested", share_of(judged.contested, judged.contacts)}};
  json["exact_step_n"] = quantiles_json(row.exact_step);
  json["exact_step_rough"] = share_of(row.exact_rough, row.exact_step.count);
  return json;
}

Json row_json(const ForceRow& row) {
  const ForceErrors& errors = row.errors;
  Json json;
  json["mesh"] = row.model;
  json["path"] = row.path;
  json["method"] = row.method;
  json["probe_radius_m"] = row.radius;
  json["turn_limit_rad_per_s"] = row.turn_rate > 0 ? Json(row.turn_rate) : Json();
  json["settings"] = row.settings;
  json["exact_rms_n"] = errors.exact_rms;
  json["difference_rms_n"] = errors.difference_rms;
  json["relative_difference"] = errors.relative();
  json["direction_difference_deg"] = quantiles_json(errors.direction, degrees);
  json["missing_ticks"] = errors.missing;
  json["spurious_ticks"] = errors.spurious;
  json["step_n"] = quantiles_json(errors.step);
  json["excess_step_n"] = quantiles_json(errors.excess);
  json["excess_step_clear_n"] = quantiles_json(errors.clear_excess);
  return json;
}

std::string method_text(const ForceRow& row) {
  if (!(row.radius > 0)) return row.method;
  return row.method + ", " + format_quantity(row.radius, Quantity::length) + " ball";
}

void append_path(const PathRow& path, const ForcesReport& report, std::string& text) {
  const auto out = std::back_inserter(text);
  const JudgedTicks& judged = path.judged;
  fmt::format_to(out,
                 "{}, {} slide: {} ticks, {} in contact; left out of these: {:.1f} % near the "
                 "medial axis, {:.1f} % deeper than the band\n"
                 "  exact penalty's step: p99 {:.3f}, p99.9 {:.3f}, max {:.3f} N; {} N or more at "
                 "{:.2f} % of the ticks\n",
                 path.model, path.path, path.ticks, judged.contacts,
                 100 * share_of(judged.contested, judged.contacts),
                 100 * share_of(judged.deep, judged.contacts), path.exact_step.p99,
                 path.exact_step.p999, path.exact_step.max, smooth_step,
                 100 * share_of(path.exact_rough, path.exact_step.count));
  fmt::format_to(out, "  {:<20} {:<40} {:>9} {:>16} {:>24} {:>24} {:>24}\n", "method", "settings",
                 "RMS, %", "deg: p50 p99", "excess N: p99 p99.9 max", "judged: p99 p99.9 max",
                 "step N: p99 p99.9 max");
  const auto three = [](const Quantiles& values) {
    return fmt::format("{:.3f} {:.3f} {:.3f}", values.p99, values.p999, values.max);
  };
  for (const ForceRow& row : report.rows) {
    if (row.model != path.model || row.path != path.path) continue;
    const ForceErrors& errors = row.errors;
    fmt::format_to(out, "  {:<20} {:<40} {:>9.2f} {:>16} {:>24} {:>24} {:>24}\n", method_text(row),
                   row.settings, 100 * errors.relative(),
                   fmt::format("{:.2f} {:.2f}", errors.direction.p50 * degrees,
                               errors.direction.p99 * degrees),
                   three(errors.excess), three(errors.clear_excess), three(errors.step));
  }
  text += "\n";
}

}  // namespace

Json to_json(const ForcesReport& report, const ForcesPlan& plan) {
  Json json;
  json["made"] = made_json();
  json["stiffness_n_per_m"] = plan.stiffness;
  json["walked_depth_m"] = plan.depth;
  json["walked_speed_m_per_s"] = walked_speed;
  json["smooth_step_n"] = smooth_step;
  json["seed"] = plan.seed;
  json["paths"] = Json::array();
  json["rows"] = Json::array();
  for (const PathRow& row : report.paths) json["paths"].push_back(path_json(row));
  for (const ForceRow& row : report.rows) json["rows"].push_back(row_json(row));
  json["failures"] = failures_json(report.failures);
  return json;
}

std::string to_text(const ForcesReport& report) {
  std::string text;
  for (const PathRow& path : report.paths) {
    if (!(path.radius > 0)) append_path(path, report, text);
  }
  return text;
}

std::string to_csv(const ForceTrace& trace, const ForcesPlan& plan) {
  std::string text = "t,x,y,z,distance,sliding,fresh,contested,exact_x,exact_y,exact_z";
  const auto out = std::back_inserter(text);
  for (const ForceTrace::Series& series : trace.series) {
    const std::string name = series.method + (series.radius > 0 ? "_ball" : "") +
                             (series.turn_rate > 0 ? "_limited" : "");
    fmt::format_to(out, ",{0}_x,{0}_y,{0}_z", name);
  }
  text += "\n";
  const auto append = [&out](const Vector3& force) {
    fmt::format_to(out, ",{:.6g},{:.6g},{:.6g}", force.x(), force.y(), force.z());
  };
  for (std::size_t i = 0; i < trace.path.points.size(); ++i) {
    const Vector3& point = trace.path.points[i];
    const ExactTick& tick = trace.path.ticks[i];
    fmt::format_to(out, "{:.3f},{:.9f},{:.9f},{:.9f},{:.9f},{:d},{:d},{:d}",
                   tick_seconds * static_cast<double>(i), point.x(), point.y(), point.z(),
                   tick.distance, tick.sliding, tick.fresh, tick.contested);
    append(exact_penalty(tick, plan.stiffness, 0));
    for (const ForceTrace::Series& series : trace.series) append(series.forces[i]);
    text += "\n";
  }
  return text;
}

}  // namespace spm::bench
