// SPDX-License-Identifier: Apache-2.0
#include "formats/scene/scene_tool.hpp"

#include <array>
#include <string_view>

#include "formats/scene/scene_placement.hpp"

namespace spm {

namespace {

constexpr std::uint64_t fewest_samples = 6;  // one for each side of a box
constexpr std::uint64_t most_samples = 2'000'000;
constexpr double longest_budget = 1;  // s

// The stiffest device that turns is rated for 15 N/mm and about 30 N m/rad. Beyond these bounds it
// is a wrong unit.
constexpr double stiffest_coupling = 1e6;  // N/m
constexpr double stiffest_turning = 1e4;   // N m/rad

/// A quantity up to `most`; nothing where the key is missing or says "auto".
std::optional<double> quantity_or_auto(TableReader& tool, const char* key, Quantity kind,
                                       const std::string& example, double most) {
  const toml::node* value = tool.node(key);
  if (value == nullptr || value->value<std::string_view>() == "auto") return std::nullopt;
  constexpr const char* or_auto = "; or \"auto\", what the device bears";
  const double read =
      tool.quantity(key, kind, example, 0, TableReader::Minimum::above_zero, or_auto);
  if (read > most) {
    tool.refuse(key, in_quotes(key) + " of [tool] is out of range; give at most " +
                         format_quantity(most, kind) + or_auto);
  }
  return read;
}

/// The first key that only an object as the tool has; null if there is none.
const char* key_of_object(const TableReader& tool) {
  for (const char* key : tool_keys) {
    const std::string_view word = key;
    const bool of_object = word != "probe" && word != "paper_probe";
    if (of_object && tool.has(key)) return key;
  }
  return nullptr;
}

double read_budget(TableReader& tool) {
  const double budget = tool.quantity("budget", Quantity::duration, "400us", 0);
  if (budget <= longest_budget) return budget;
  tool.refuse("budget",
              "'budget' is longer than a second; give what the tool may take of a tick, such as "
              "\"400us\"");
  return 0;
}

}  // namespace

std::optional<ProbeShape> read_probe(TableReader& tool) {
  const std::string text = tool.text("probe", "sphere:0.5mm");
  if (text.empty()) return std::nullopt;
  const Result<ProbeShape> probe = parse_probe_shape(text);
  if (probe) return *probe;
  tool.refuse("probe", "'probe': " + probe.error().message);
  return std::nullopt;
}

std::optional<PaperProbeForm> read_probe_form(TableReader& tool) {
  constexpr std::array forms{PaperProbeForm::surface, PaperProbeForm::volume};
  const auto word = tool.word("paper_probe", {"surface", "volume"});
  return word ? std::optional(forms[*word]) : std::nullopt;
}

std::optional<SceneTool> read_tool(TableReader& tool) {
  const char* first = key_of_object(tool);
  if (first == nullptr) return std::nullopt;
  if (!tool.has("asset") && !tool.has("mesh")) {
    tool.refuse(first, in_quotes(first) +
                           " is of a tool that is an object; add 'asset', its baked file, or leave "
                           "the key out");
    return std::nullopt;
  }
  const char* named = tool.has("asset") ? "asset" : "mesh";
  if (tool.has("probe")) {
    tool.refuse(named,
                "'probe' and " + in_quotes(named) +
                    " exclude each other: the tool is a point or a ball, or an object of its own; "
                    "leave one of them out");
  }
  if (tool.has("paper_probe")) {
    tool.refuse(
        "paper_probe",
        "'paper_probe' is of a ball that touches, and the tool is an object of its own by " +
            in_quotes(named) + "; leave 'paper_probe' out");
  }
  if (tool.has("samples") && tool.has("spacing")) {
    tool.refuse("samples",
                "'samples' and 'spacing' both say how finely the tool is sampled; leave one of "
                "them out");
  }
  SceneTool read;
  read.line = tool.line(named);
  read.asset = tool.text("asset", "drill.spm.exr");
  read.mesh = tool.text("mesh", "drill.obj");
  read.placement = read_placement(tool);
  read.coupling =
      quantity_or_auto(tool, "coupling", Quantity::stiffness, "2N/mm", stiffest_coupling);
  read.turning =
      quantity_or_auto(tool, "turning", Quantity::turning_stiffness, "2N m/rad", stiffest_turning);
  if (tool.has("torque_cap")) {
    read.torque_cap =
        tool.quantity("torque_cap", Quantity::torque, "100mNm", 0, TableReader::Minimum::zero);
  }
  read.samples = static_cast<std::size_t>(tool.whole("samples", fewest_samples, most_samples, 0));
  read.spacing = tool.quantity("spacing", Quantity::length, "0.5mm", 0);
  read.budget = read_budget(tool);
  return read;
}

}  // namespace spm
