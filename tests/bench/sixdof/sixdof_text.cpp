// SPDX-License-Identifier: GPL-3.0-or-later
#include "tests/bench/sixdof/sixdof_text.hpp"

#include <fmt/format.h>

#include <iterator>
#include <numbers>

#include "tests/bench/base/machine.hpp"

namespace spm::bench {
namespace {

using Json = nlohmann::ordered_json;

constexpr double micro = 1e6;
constexpr double degrees = 180 / std::numbers::pi;

Json quantiles_json(const TickQuantiles& values, double unit) {
  return {{"median", values.median * unit}, {"p95", values.p95 * unit}, {"p99", values.p99 * unit}};
}

Json percents_json(const std::optional<TickQuantiles>& values) {
  return values ? quantiles_json(*values, 100) : Json();
}

Json row_json(const SixdofRow& row) {
  Json json;
  json["path"] = row.path;
  json["method"] = row.method;
  json["settings"] = row.settings;
  json["samples"] = row.samples > 0 ? Json(row.samples) : Json();
  json["p50_us"] = row.p50 * micro;
  json["p99_us"] = row.p99 * micro;
  json["max_us"] = row.max * micro;
  json["mean_us"] = row.mean * micro;
  json["busy_p99_us"] = row.busy_p99 * micro;
  json["samples_tested"] = row.tested;
  json["field_queries"] = row.asked;
  json["contacts"] = row.contacts;
  json["level"] = row.level;
  json["degraded"] = row.degraded;
  json["force_error_percent"] = percents_json(row.force_error);
  json["torque_error_percent"] = percents_json(row.torque_error);
  json["finest_force_error_percent"] = percents_json(row.finest_force_error);
  json["finest_torque_error_percent"] = percents_json(row.finest_torque_error);
  json["bytes"] = row.bytes > 0 ? Json(row.bytes) : Json();
  json["direction_error_deg"] = quantiles_json(row.direction_error, degrees);
  return json;
}

/// Of the pairs that the axis-aligned boxes leave, the share that is found to be apart.
double told_apart(const CullingRow& row, std::uint64_t left) {
  return row.after_aabb > 0 ? 1 - static_cast<double>(left) / static_cast<double>(row.after_aabb)
                            : 0;
}

Json culling_json(const CullingRow& row) {
  return {{"scene", row.scene},
          {"objects", row.objects},
          {"pairs", row.pairs},
          {"after_aabb", row.after_aabb},
          {"after_obb", row.after_obb},
          {"after_spm", row.after_spm},
          {"hulls_touch", row.touching},
          {"rejected_obb", told_apart(row, row.after_obb)},
          {"rejected_spm", told_apart(row, row.after_spm)},
          {"aabb_ns", row.aabb_ns},
          {"obb_ns", row.obb_ns},
          {"spm_ns", row.spm_ns},
          {"remembered", row.remembered}};
}

void append_culling(const SixdofReport& report, std::string& text) {
  const auto out = std::back_inserter(text);
  fmt::format_to(out,
                 "\nculling of copies of the tool, a hull of {} points; pairs left, and ns a pair "
                 "asked\n  {:<7} {:>7} {:>9} {:>8} {:>8} {:>8} {:>8}  {:>6} {:>6} {:>6}  {:>6}\n",
                 report.culling.hull_points, "scene", "objects", "pairs", "AABB", "OBB", "SPM",
                 "touch", "AABB", "OBB", "SPM", "kept %");
  for (const CullingRow& row : report.culling.rows) {
    fmt::format_to(
        out, "  {:<7} {:>7} {:>9} {:>8} {:>8} {:>8} {:>8}  {:>6.1f} {:>6.1f} {:>6.1f}  {:>6.1f}\n",
        row.scene, row.objects, row.pairs, row.after_aabb, row.after_obb, row.after_spm,
        row.touching, row.aabb_ns, row.obb_ns, row.spm_ns, 100 * row.remembered);
  }
}

}  // namespace

Json to_json(const SixdofReport& report) {
  Json json;
  json["made"] = made_json();
  json["tool"] = {{"mesh", report.tool}, {"triangles", report.tool_triangles}};
  json["object"] = {{"mesh", report.object}, {"triangles", report.object_triangles}};
  json["ticks"] = report.ticks;
  json["judged"] = report.judged;
  json["judged_deep"] = report.judged_deep;
  json["reference_radius_um"] = micro * report.reference_radius;
  json["rows"] = Json::array();
  for (const SixdofRow& row : report.rows) json["rows"].push_back(row_json(row));
  json["culling"] = Json::array();
  for (const CullingRow& row : report.culling.rows) json["culling"].push_back(culling_json(row));
  return json;
}

std::string to_text(const SixdofReport& report) {
  std::string text;
  const auto out = std::back_inserter(text);
  fmt::format_to(
      out,
      "{} ({} triangles) on {} ({} triangles): {} ticks; forces judged at {}, deep "
      "ones at {}, by the overlap of the exact meshes, integrated to {:.0f} um, and by every "
      "sample of the finest level\n",
      report.tool, report.tool_triangles, report.object, report.object_triangles, report.ticks,
      report.judged, report.judged_deep, micro * report.reference_radius);
  fmt::format_to(out,
                 "  {:<5} {:<13} {:<25} {:>31}  {:>8} {:>8} {:>8} {:>6}  {:>15} {:>15} {:>15} "
                 "{:>15} {:>12} {:>8}\n",
                 "path", "method", "settings", "us a tick: p50    p99 busy p99   mean", "tested",
                 "asked", "contacts", "degr %", "force %: 50  95", "torque: 50  95",
                 "finest: f 50 95", "t 50        95", "deg: 50   95", "kB");
  for (const SixdofRow& row : report.rows) {
    fmt::format_to(
        out,
        "  {:<5} {:<13} {:<25} {:>12.1f} {:>8.1f} {:>7.0f} {:>6.1f}  {:>8.1f} {:>8.1f} {:>8.1f} "
        "{:>6.2f}  ",
        row.path, row.method, row.settings, row.p50 * micro, row.p99 * micro, row.busy_p99 * micro,
        row.mean * micro, row.tested, row.asked, row.contacts, 100 * row.degraded);
    for (const auto& error :
         {row.force_error, row.torque_error, row.finest_force_error, row.finest_torque_error}) {
      if (error) {
        fmt::format_to(out, "{:>8.2f} {:>7.2f}", 100 * error->median, 100 * error->p95);
      } else {
        fmt::format_to(out, "{:>8} {:>7}", "-", "-");
      }
    }
    fmt::format_to(out, "  {:>6.2f} {:>5.1f} {:>8}\n", row.direction_error.median * degrees,
                   row.direction_error.p95 * degrees, row.bytes / 1000);
  }
  append_culling(report, text);
  return text;
}

}  // namespace spm::bench
