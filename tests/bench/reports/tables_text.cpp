// SPDX-License-Identifier: GPL-3.0-or-later
#include "tests/bench/reports/tables_text.hpp"

#include <fmt/format.h>

#include <array>
#include <iterator>

#include "tests/bench/base/machine.hpp"
#include "tests/bench/reports/row_text.hpp"

namespace spm::bench {
namespace {

using Json = nlohmann::ordered_json;

constexpr std::array titles{"Table 1, measured: growth with triangles and with support planes",
                            "Table 2: Galeon, recorded slide", "Table 3: Teeth, recorded slide"};

Json row_json(const TableRow& row) {
  Json json;
  json["table"] = row.table;
  json["model"] = row.model;
  json["triangles"] = row.triangles;
  json["process"] = row.process;
  json["method"] = row.method;
  json["settings"] = row.settings;
  json["planes"] = row.planes > 0 ? Json(row.planes) : Json();
  json["with_collision_detection"] = row.with_collision_detection;
  json["mean_us"] = row.us.mean;
  json["sd_us"] = row.us.sd;
  json["p50_us"] = row.us.p50;
  json["p99_us"] = row.us.p99;
  json["ticks"] = row.us.ticks;
  json["contact_ticks"] = row.us.contacts;
  json["bytes"] = row.bytes;
  json["paper_mean_us"] = row.paper ? Json(row.paper->mean) : Json();
  json["paper_sd_us"] = row.paper ? Json(row.paper->sd) : Json();
  return json;
}

Json growth_json(const GrowthRow& row) {
  return {{"method", row.method},
          {"settings", row.settings},
          {"with_collision_detection", row.with_collision_detection},
          {"over", row.over},
          {"exponent", row.exponent}};
}

void append_row(const TableRow& row, std::string& text) {
  const auto out = std::back_inserter(text);
  fmt::format_to(out,
                 "  {:<10} {:>9} {:<10} {:<32} {:<7} {:>9.3f} {:>9.3f} {:>9.3f} {:>9.3f} {:>9}",
                 row.process, row.triangles, row.method, row.settings,
                 row.with_collision_detection ? "with" : "without", row.us.mean, row.us.sd,
                 row.us.p50, row.us.p99, byte_text(static_cast<double>(row.bytes)));
  if (row.paper) fmt::format_to(out, "  {:g} ({:g})", row.paper->mean, row.paper->sd);
  text += "\n";
}

}  // namespace

Json to_json(const TablesReport& report) {
  Json json;
  json["made"] = made_json();
  json["rows"] = Json::array();
  json["growth"] = Json::array();
  for (const TableRow& row : report.rows) json["rows"].push_back(row_json(row));
  for (const GrowthRow& row : report.growth) json["growth"].push_back(growth_json(row));
  json["failures"] = failures_json(report.failures);
  return json;
}

std::string to_text(const TablesReport& report) {
  std::string text;
  const auto out = std::back_inserter(text);
  for (std::size_t table = 1; table <= titles.size(); ++table) {
    fmt::format_to(out,
                   "{}\n  {:<10} {:>9} {:<10} {:<32} {:<7} {:>9} {:>9} {:>9} {:>9} {:>9}  {}\n",
                   titles[table - 1], "process", "triangles", "method", "settings", "search",
                   "us: mean", "sd", "p50", "p99", "bytes", "paper: mean (sd)");
    for (const TableRow& row : report.rows) {
      if (row.table == static_cast<int>(table)) append_row(row, text);
    }
    text += "\n";
  }
  for (const GrowthRow& row : report.growth) {
    fmt::format_to(out, "{} {}{} grows with {} to the power {:.2f}\n", row.method, row.settings,
                   row.with_collision_detection ? "" : " without the search", row.over,
                   row.exponent);
  }
  return text;
}

}  // namespace spm::bench
