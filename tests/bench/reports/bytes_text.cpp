// SPDX-License-Identifier: GPL-3.0-or-later
#include "tests/bench/reports/bytes_text.hpp"

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

Json row_json(const MethodRow& row) {
  Json json = facts_json(row.model, row.facts);
  add_score(row.score, json);
  return json;
}

double times(const ComparisonRow& row) {
  return row.size->bytes / static_cast<double>(row.spm_bytes);
}

Json comparison_json(const ComparisonRow& row) {
  Json json;
  json["mesh"] = row.model;
  json["method"] = row.method;
  json["depth_error_um"] = {{"p99", row.error * micro}};
  json["spm_bytes"] = row.spm_bytes;
  json["bytes"] = row.size ? Json(row.size->bytes) : Json();
  json["times_spm"] = row.size ? Json(times(row)) : Json();
  json["estimate"] = row.size ? Json(to_string(row.size->estimate)) : Json();
  json["slope"] = row.size ? Json(row.size->slope) : Json();
  return json;
}

void append_row(const MethodRow& row, std::string& text) {
  const Score& score = row.score;
  fmt::format_to(
      std::back_inserter(text),
      "  {:<13} {:<24} {:>9} {:>9} {:>7.2f}  {:>7.3g} {:>7.3g} {:>7.3g}  {:>5.2f} {:>5.1f}  "
      "{:>8.4g} {:>8.4g}\n",
      row.facts.name, row.facts.settings, byte_text(static_cast<double>(row.facts.file_bytes)),
      byte_text(static_cast<double>(row.facts.resident_bytes)), row.facts.build_seconds,
      score.p50 * micro, score.p99 * micro, score.max * micro, score.direction_p50 * degrees,
      score.direction_p99 * degrees, 100 * score.misclassified, 100 * score.unanswered);
}

void append_comparison(const ComparisonRow& row, std::string& text) {
  const auto out = std::back_inserter(text);
  if (!row.size) {
    fmt::format_to(out,
                   "  {:<13} cannot be estimated: too few settings, or more bytes that err more\n",
                   row.method);
    return;
  }
  const std::string how = row.size->estimate == Estimate::measured
                              ? std::string("measured, its smallest setting, which has no error")
                              : fmt::format("{}, bytes as the error to the power {:.2f}",
                                            to_string(row.size->estimate), row.size->slope);
  fmt::format_to(out, "  {:<13} {:>9}, {:.3g} times ours ({})\n", row.method,
                 byte_text(row.size->bytes), times(row), how);
}

}  // namespace

Json to_json(const BytesReport& report) {
  Json json;
  json["made"] = made_json();
  json["band_m"] = bench_band.max_depth;
  json["margin_m"] = bench_band.margin;
  json["diagonal_m"] = bench_diagonal;
  json["meshes"] = Json::array();
  json["rows"] = Json::array();
  json["comparisons"] = Json::array();
  for (const ModelRow& model : report.models) json["meshes"].push_back(model_json(model));
  for (const MethodRow& row : report.rows) json["rows"].push_back(row_json(row));
  for (const ComparisonRow& row : report.comparisons) {
    json["comparisons"].push_back(comparison_json(row));
  }
  json["failures"] = failures_json(report.failures);
  return json;
}

std::string to_text(const BytesReport& report) {
  std::string text;
  const auto out = std::back_inserter(text);
  for (const ModelRow& model : report.models) {
    fmt::format_to(out,
                   "{}: {} triangles, tolerance {}, {} places; no direction at {:.1f} % of them\n",
                   model.name, model.triangles, format_quantity(model.tolerance, Quantity::length),
                   model.samples, 100 * model.contested);
    fmt::format_to(out, "  {:<13} {:<24} {:>9} {:>9} {:>7}  {:>23}  {:>11}  {:>8} {:>8}\n",
                   "method", "settings", "file", "resident", "build s", "um: p50     p99     max",
                   "deg: 50   99", "wrong %", "none %");
    for (const MethodRow& row : report.rows) {
      if (row.model == model.name) append_row(row, text);
    }
    bool titled = false;
    for (const ComparisonRow& row : report.comparisons) {
      if (row.model != model.name) continue;
      if (!titled) {
        fmt::format_to(
            out, "  bytes of memory for 99 % of the errors below {:.3g} um, where spm needs {}:\n",
            row.error * micro, byte_text(static_cast<double>(row.spm_bytes)));
        titled = true;
      }
      append_comparison(row, text);
    }
    text += "\n";
  }
  return text;
}

}  // namespace spm::bench
