// SPDX-License-Identifier: GPL-3.0-or-later
#include "tests/bench/reports/row_text.hpp"

#include <fmt/format.h>
#include <spdlog/spdlog.h>

#include <numbers>

namespace spm::bench {
namespace {

using Json = nlohmann::ordered_json;

constexpr double micro = 1e6;
constexpr double degrees = 180 / std::numbers::pi;

}  // namespace

Json model_json(const ModelRow& model) {
  return {{"mesh", model.name},         {"triangles", model.triangles},
          {"vertices", model.vertices}, {"tolerance_um", model.tolerance * micro},
          {"samples", model.samples},   {"direction_contested", model.contested}};
}

Json facts_json(const std::string& model, const MethodFacts& facts) {
  Json json;
  json["mesh"] = model;
  json["method"] = facts.name;
  json["settings"] = facts.settings;
  json["setting_um"] = facts.setting > 0 ? Json(facts.setting * micro) : Json();
  json["bytes"] = facts.resident_bytes;
  json["file_bytes"] = facts.file_bytes;
  json["resident_bytes"] = facts.resident_bytes;
  json["build_seconds"] = facts.build_seconds;
  json["open_seconds"] = facts.open_seconds;
  return json;
}

void add_score(const Score& score, Json& row) {
  row["depth_error_um"] = {{"rms", score.rms * micro},
                           {"p50", score.p50 * micro},
                           {"p99", score.p99 * micro},
                           {"max", score.max * micro}};
  row["direction_error_deg"] = {{"p50", score.direction_p50 * degrees},
                                {"p99", score.direction_p99 * degrees}};
  row["misclassified"] = score.misclassified;
  row["unanswered"] = score.unanswered;
}

Json failures_json(const std::vector<FailureRow>& failures) {
  Json json = Json::array();
  for (const FailureRow& row : failures) {
    json.push_back({{"mesh", row.model}, {"method", row.method}, {"reason", row.reason}});
  }
  return json;
}

void warn_of(const std::vector<FailureRow>& failures) {
  for (const FailureRow& failure : failures) {
    spdlog::warn("{}, {}: no row: {}", failure.model, failure.method, failure.reason);
  }
}

std::string byte_text(double bytes) {
  return bytes < 1e7 ? fmt::format("{:.0f} kB", bytes / 1e3)
                     : fmt::format("{:.1f} MB", bytes / 1e6);
}

}  // namespace spm::bench
