// SPDX-License-Identifier: GPL-3.0-or-later
#include "tests/bench/reports/times_text.hpp"

#include <fmt/format.h>

#include <iterator>
#include <numbers>

#include "common/base/units.hpp"
#include "tests/bench/base/machine.hpp"
#include "tests/bench/reports/row_text.hpp"

namespace spm::bench {
namespace {

using Json = nlohmann::ordered_json;

constexpr double micro = 1e6;
constexpr double degrees = 180 / std::numbers::pi;

Json times_json(const QueryTimes& times) {
  return {{"hot", times.hot},
          {"hot_p99", times.hot_p99},
          {"random", times.random},
          {"cold", times.cold}};
}

Json row_json(const TimesRow& row) {
  Json json = facts_json(row.model, row.facts);
  json["ns"] = times_json(row.ns);
  add_score(row.score, json);
  json["errors_on"] = row.on_path ? "path" : "places";
  return json;
}

Json probe_json(const ProbeRow& row) {
  Json json;
  json["mesh"] = row.model;
  json["method"] = row.method;
  json["settings"] = row.settings;
  json["ns"] = {{"hot", row.hot}};
  json["depth_error_um"] = {{"p50", row.p50 * micro}, {"p99", row.p99 * micro}};
  json["missed_contacts"] = row.missed;
  return json;
}

double ratio(std::uint64_t theirs, std::uint64_t ours) {
  return static_cast<double>(theirs) / static_cast<double>(ours);
}

/// Times of each rival's row in those of `spm` at the model's own tolerance, of this very run.
Json ratios_json(const TimesReport& report) {
  Json json = Json::array();
  for (const ModelRow& model : report.models) {
    const TimesRow* ours = own_row(report, model);
    if (ours == nullptr) continue;
    for (const TimesRow& row : report.rows) {
      if (row.model != model.name || row.facts.name == "spm") continue;
      json.push_back(
          {{"mesh", row.model},
           {"method", row.facts.name},
           {"settings", row.facts.settings},
           {"ns_times_spm",
            times_json({row.ns.hot / ours->ns.hot, row.ns.hot_p99 / ours->ns.hot_p99,
                        row.ns.random / ours->ns.random, row.ns.cold / ours->ns.cold})},
           {"bytes_times_spm", ratio(row.facts.resident_bytes, ours->facts.resident_bytes)},
           {"file_bytes_times_spm", ratio(row.facts.file_bytes, ours->facts.file_bytes)}});
    }
  }
  return json;
}

void append_row(const TimesRow& row, const TimesRow* ours, std::string& text) {
  const auto out = std::back_inserter(text);
  const Score& score = row.score;
  fmt::format_to(
      out, "  {:<13} {:<26} {:>9} {:>9} {:>7.2f} {:>6.2f}  {:>8.0f} {:>7.0f} {:>8.0f} {:>8.0f}",
      row.facts.name, row.facts.settings, byte_text(static_cast<double>(row.facts.file_bytes)),
      byte_text(static_cast<double>(row.facts.resident_bytes)), row.facts.build_seconds,
      row.facts.open_seconds, row.ns.hot, row.ns.hot_p99, row.ns.random, row.ns.cold);
  if (ours != nullptr) {
    fmt::format_to(out, " {:>6.2f}", row.ns.hot / ours->ns.hot);
  } else {
    fmt::format_to(out, " {:>6}", "");
  }
  fmt::format_to(out, "  {:>7.3g} {:>7.3g} {:>7.3g}  {:>5.2f} {:>5.1f}  {:>8.4g} {:>8.4g}{}\n",
                 score.p50 * micro, score.p99 * micro, score.max * micro,
                 score.direction_p50 * degrees, score.direction_p99 * degrees,
                 100 * score.misclassified, 100 * score.unanswered, row.on_path ? "  path" : "");
}

void append_probe(const ProbeRow& row, std::string& text) {
  fmt::format_to(
      std::back_inserter(text),
      "  {:<13} {:<26} {:>9} {:>24}  {:>8.0f} {:>32}  {:>7.3g} {:>7.3g}  missed {:.3g} %\n",
      row.method, row.settings, "ball", "", row.hot, "", row.p50 * micro, row.p99 * micro,
      100 * row.missed);
}

}  // namespace

Json to_json(const TimesReport& report, const TimesPlan& plan) {
  Json json;
  json["made"] = made_json();
  json["band_m"] = bench_band.max_depth;
  json["margin_m"] = bench_band.margin;
  json["diagonal_m"] = bench_diagonal;
  json["probe_radius_m"] = plan.probe_radius;
  json["timing"] = {{"path_steps", plan.path_steps},
                    {"rounds", plan.timing.rounds},
                    {"cold_queries", plan.timing.cold_queries},
                    {"cold_bytes", plan.timing.cold_bytes}};
  json["meshes"] = Json::array();
  json["rows"] = Json::array();
  json["probe_rows"] = Json::array();
  for (const ModelRow& model : report.models) json["meshes"].push_back(model_json(model));
  for (const TimesRow& row : report.rows) json["rows"].push_back(row_json(row));
  for (const ProbeRow& row : report.probe_rows) json["probe_rows"].push_back(probe_json(row));
  json["ratios"] = ratios_json(report);
  json["failures"] = failures_json(report.failures);
  return json;
}

std::string to_text(const TimesReport& report) {
  std::string text;
  const auto out = std::back_inserter(text);
  for (const ModelRow& model : report.models) {
    fmt::format_to(out, "{}: {} triangles, tolerance {}, {} places\n", model.name, model.triangles,
                   format_quantity(model.tolerance, Quantity::length), model.samples);
    fmt::format_to(
        out, "  {:<13} {:<26} {:>9} {:>9} {:>7} {:>6}  {:>34} {:>6}  {:>23}  {:>11}  {:>8} {:>8}\n",
        "method", "settings", "file", "resident", "build s", "open s",
        "ns: hot hot p99   random     cold", "x spm", "um: p50     p99     max", "deg: 50   99",
        "wrong %", "none %");
    const TimesRow* ours = own_row(report, model);
    for (const TimesRow& row : report.rows) {
      if (row.model == model.name) append_row(row, ours, text);
    }
    for (const ProbeRow& row : report.probe_rows) {
      if (row.model == model.name) append_probe(row, text);
    }
    text += "\n";
  }
  return text;
}

}  // namespace spm::bench
