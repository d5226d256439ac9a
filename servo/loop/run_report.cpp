// SPDX-License-Identifier: Apache-2.0
#include "servo/loop/run_report.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <numeric>

#include "common/base/units.hpp"
#include "common/contact/stable_stiffness.hpp"
#include "servo/scene/force_choice.hpp"

namespace spm::servo {

using nlohmann::ordered_json;

namespace {

ForceOffTicks sum_force_off(const RunReport& report) {
  ForceOffTicks sum{};
  for (const DeviceReport& device : report.devices) {
    for (std::size_t i = 0; i < force_off_count; ++i) sum[i] += device.counters.force_off[i];
  }
  return sum;
}

ordered_json force_off_json(const ForceOffTicks& ticks) {
  ordered_json list = ordered_json::array();
  for (std::size_t i = 0; i < force_off_count; ++i) {
    if (ticks[i] == 0) continue;
    const auto cause = static_cast<ForceOff>(i);
    list.push_back({{"cause", to_string(cause)}, {"count", ticks[i]}, {"cure", cure_of(cause)}});
  }
  return list;
}

/// Answers of objects that were coarser than with more time, by how.
ordered_json degraded_json(std::uint64_t held, std::uint64_t shortened) {
  return {{"held", held}, {"shortened", shortened}};
}

double force_cap_of(const RunReport& report, const DeviceCapabilities& device) {
  return std::min(device.force_cap, report.force.device.force_cap.value_or(device.force_cap));
}

/// Of a device by its number.
double torque_cap_of(const RunReport& report, std::size_t number) {
  const double own = hand_turning(report.devices[number].capabilities).torque_cap;
  const ToolSettings* tool = tool_of(report.force.scene, number);
  return tool != nullptr ? std::min(own, tool->torque_cap) : own;
}

/// What a device that gives torque, or a hand that holds a tool, did beside force.
void add_turning(ordered_json& entry, const RunReport& report, std::size_t number) {
  const DeviceCounters& counters = report.devices[number].counters;
  const double cap = torque_cap_of(report, number);
  if (cap > 0) {
    if (std::isfinite(cap)) entry["torque_cap_n_m"] = cap;
    entry["torque_max_n_m"] = counters.torque_max;
    entry["torque_cap_hits"] = counters.torque_cap_hits;
    entry["torque_slew_hits"] = counters.torque_slew_hits;
  }
  if (!report.force.scene.tool) return;
  entry["tool_cap_hits"] = counters.tool_cap_hits;
  entry["tool_leaving_ticks"] = counters.tool_leaving;
  entry["coarse_ticks"] = counters.coarse;
}

ordered_json devices_json(const RunReport& report) {
  ordered_json list = ordered_json::array();
  for (const DeviceReport& device : report.devices) {
    ordered_json entry = {{"name", device.capabilities.name},
                          {"force_cap_n", force_cap_of(report, device.capabilities)},
                          {"encoder_step_m", device.capabilities.encoder_step}};
    if (std::isfinite(device.capabilities.stiffness_cap)) {
      entry["stiffness_cap_n_per_m"] = device.capabilities.stiffness_cap;
    }
    const Vector3& half = device.capabilities.workspace;
    if (!half.isZero()) entry["workspace_m"] = {2 * half.x(), 2 * half.y(), 2 * half.z()};
    entry.update(device.details);
    entry["delay"] = {{"measured_ticks", device.delay.measured},
                      {"counted_ticks", device.delay.counted},
                      {"stiffest_n_per_m", device.delay.stiffest}};
    entry["contact_ticks"] = device.counters.contact_ticks;
    entry["force_max_n"] = device.counters.force_max;
    entry["cap_hits"] = device.counters.cap_hits;
    entry["slew_hits"] = device.counters.slew_hits;
    entry["energy_j"] = device.counters.energy;
    add_turning(entry, report, list.size());
    entry["degraded_ticks"] = device.counters.degraded_ticks;
    entry["degraded_answers"] = degraded_json(device.counters.held, device.counters.shortened);
    entry["force_off"] = force_off_json(device.counters.force_off);
    list.push_back(std::move(entry));
  }
  return list;
}

ordered_json assets_json(const RunReport& report) {
  ordered_json list = ordered_json::array();
  for (std::size_t i = 0; i < report.assets.size(); ++i) {
    const KeeperReport& asset = report.assets[i];
    list.push_back({{"path", report.force.assets[i]},
                    {"form", to_string(asset.metadata.form)},
                    {"content_sha256", asset.content_sha256},
                    {"mesh_sha256", asset.metadata.mesh_sha256},
                    {"bytes", asset.bytes.total},
                    {"resident_bytes", asset.resident_bytes},
                    {"open_seconds", asset.open_seconds},
                    {"map", report.options.map == MapMode::sealed ? "sealed" : "file"},
                    {"locked", asset.locked},
                    {"serving", asset.serving},
                    {"losses", asset.losses},
                    {"reloads", asset.reloads}});
    std::size_t most = 0;
    for (const ToolReport& tool : asset.tools) most = std::max(most, tool.samples);
    if (most == 0) continue;
    list.back()["tool_samples"] = most;
    list.back()["tool_bytes"] = asset.tool_bytes;
  }
  return list;
}

/// Sums over all devices.
struct Totals {
  double force_max = 0;
  double generated_max = 0;
  std::uint64_t cap_hits = 0;
  std::uint64_t held = 0, shortened = 0;
};

Totals totals_of(const RunReport& report) {
  Totals totals;
  for (const DeviceReport& device : report.devices) {
    totals.force_max = std::max(totals.force_max, device.counters.force_max);
    totals.generated_max = std::max(totals.generated_max, device.counters.generated_max);
    totals.cap_hits += device.counters.cap_hits;
    totals.held += device.counters.held;
    totals.shortened += device.counters.shortened;
  }
  return totals;
}

std::string percentiles_text(const Summary& us) {
  return fmt::format("p50 {:.1f}, p99 {:.1f}, p99.9 {:.1f}, max {:.1f} us", us.p50, us.p99, us.p999,
                     us.max);
}

/// One device of several, in one line.
std::string device_text(std::size_t number, const DeviceReport& device) {
  const DeviceCounters& counters = device.counters;
  std::string text =
      fmt::format("device {} {}: in contact for {} ticks, largest force {:.3f} N, force off for {}",
                  number, device.capabilities.name, counters.contact_ticks, counters.force_max,
                  std::accumulate(counters.force_off.begin(), counters.force_off.end(), 0ULL));
  return text + " ticks\n";
}

/// Of the devices that give torque, or whose hands hold a tool; empty where there are none.
std::string turning_text(const RunReport& report) {
  std::string text;
  for (std::size_t i = 0; i < report.devices.size(); ++i) {
    const DeviceCounters& counters = report.devices[i].counters;
    const std::string& name = report.devices[i].capabilities.name;
    if (torque_cap_of(report, i) > 0) {
      text += fmt::format("{}: largest torque {:.4f} N m, torque cap met {} times\n", name,
                          counters.torque_max, counters.torque_cap_hits);
    }
    if (report.force.scene.tool) {
      text += fmt::format(
          "{}: the tool's coupling met its cap {} times; {} ticks at a coarser level of its "
          "samples\n",
          name, counters.tool_cap_hits, counters.coarse);
    }
    if (counters.tool_leaving > 0) {
      text += fmt::format(
          "{}: the tool lay in an object, or in another tool, for {} ticks, and was led out "
          "slowly: "
          "begin with the hand where nothing is\n",
          name, counters.tool_leaving);
    }
  }
  return text;
}

/// A tool that is an object, as the scene names it.
ordered_json tool_json(const ForceChoice& choice, const ToolSettings& tool) {
  ordered_json entry = {{"asset", choice.assets[tool.asset]}, {"scale", tool.placement.scale}};
  if (tool.coupling > 0) entry["coupling_n_m"] = tool.coupling;
  if (tool.turning > 0) entry["turning_nm_rad"] = tool.turning;
  if (std::isfinite(tool.torque_cap)) entry["torque_cap_n_m"] = tool.torque_cap;
  if (tool.budget > 0) entry["budget_s"] = tool.budget;
  return entry;
}

/// `tool` where all devices hold one, `tools` where each has its own.
void add_tools(ordered_json& report, const ForceChoice& choice) {
  if (!tools_meet(choice.scene)) {
    report["tool"] = tool_json(choice, *choice.scene.tool);
    return;
  }
  for (std::size_t k = 0; k < tools_of(choice.scene); ++k) {
    report["tools"].push_back(tool_json(choice, *tool_of(choice.scene, k)));
  }
}

/// How the tools of a report were sampled; a `full` one is not.
void add_samples(ordered_json& json, const RunReport& report) {
  const ForceScene& scene = report.force.scene;
  for (std::size_t k = 0; k < tools_of(scene); ++k) {
    const std::vector<ToolReport>& tools = report.assets[tool_of(scene, k)->asset].tools;
    if (k >= tools.size() || tools[k].samples == 0) continue;
    ordered_json& entry = tools_meet(scene) ? json["tools"][k] : json["tool"];
    entry["samples"] = tools[k].samples;
    entry["spacing_m"] = tools[k].spacing;
  }
}

}  // namespace

ordered_json percentiles_json(const Summary& summary) {
  return {{"p50", summary.p50}, {"p99", summary.p99}, {"p999", summary.p999}, {"max", summary.max}};
}

void add_forces(ordered_json& report, const ForceChoice& choice) {
  const ForceSettings& first = choice.scene.objects.front().force;
  if (choice.scene_path.empty()) {
    report["method"] = to_string(first.method);
    if (first.method == Method::paper) report["paper_rule"] = to_string(first.rule);
    report["stiffness_n_m"] = first.stiffness;
    report["objects"].push_back(
        {{"method", to_string(first.method)}, {"stiffness", first.stiffness}});
  } else {
    report["scene"] = choice.scene_path;
    for (const PlacedObject& object : choice.scene.objects) {
      ordered_json entry = {{"asset", choice.assets[object.asset]},
                            {"method", to_string(object.force.method)},
                            {"stiffness", object.force.stiffness},
                            {"stiffness_n_m", object.force.stiffness},
                            {"scale", object.placement.scale}};
      if (object.force.method == Method::paper) entry["paper_rule"] = to_string(object.force.rule);
      report["objects"].push_back(std::move(entry));
    }
  }
  const StabilizationSettings& stabilization = choice.scene.stabilization;
  report["stabilization"] = stabilization.any();
  if (stabilization.any()) {
    report["stabilization_settings"] = {{"damping_share", stabilization.damping_share},
                                        {"delay_ticks", stabilization.delay_ticks},
                                        {"lag_s", stabilization.lag},
                                        {"coupling_n_m", stabilization.coupling},
                                        {"passivity", stabilization.passivity},
                                        {"potential_m", stabilization.potential}};
  }
  if (choice.scene.tool) {
    add_tools(report, choice);
    return;
  }
  report["probe"] = text_of(choice.probe);
  report["probe_radius_m"] = choice.probe.radius;
  if (choice.probe.paper_only()) report["probe_length_m"] = choice.probe.length;
  const auto& objects = choice.scene.objects;
  const bool averaged =
      choice.probe.radius > 0 && std::any_of(objects.begin(), objects.end(), [](const auto& one) {
        return one.force.method == Method::paper;
      });
  if (averaged) report["paper_probe"] = to_string(choice.probe_form());
}

ordered_json to_json(const RunReport& report) {
  const Totals totals = totals_of(report);
  const LoopCounters& counters = report.counters;
  ordered_json json = {{"ticks", counters.ticks},
                       {"missed", counters.missed},
                       {"skipped", counters.skipped},
                       {"unrecorded", counters.unrecorded},
                       {"contact_ticks", counters.contact_ticks},
                       {"rate_hz", report.options.rate_hz}};
  add_forces(json, report.force);
  add_samples(json, report);
  json["wake_us"] = percentiles_json(report.wake_us);
  json["busy_us"] = percentiles_json(report.busy_us);
  json["tick_budget"] = report.options.tick_budget;
  json["degraded_ticks"] = counters.degraded_ticks;
  json["degraded_answers"] = degraded_json(totals.held, totals.shortened);
  json["page_faults"] = counters.page_faults;
  json["realtime"] = {{"policy", report.realtime.policy},
                      {"priority", report.realtime.priority},
                      {"memory_locked", report.realtime.memory_locked},
                      {"cpu_dma_latency", {{"held", report.latency_held}}}};
  if (!report.latency_held) {
    json["realtime"]["cpu_dma_latency"]["why"] = report.latency_not_held;
  }
  json["recovery"] = report.options.acknowledge ? "acknowledge" : "automatic";
  if (report.options.enable_button > 0) {
    json["enable_switch"] = fmt::format("button:{}", report.options.enable_button);
  }
  json["force_off"] = force_off_json(sum_force_off(report));
  json["force_n"] = {{"max", totals.force_max}, {"cap_hits", totals.cap_hits}};
  json["energy_j"] = {{"generated_max", totals.generated_max}};
  if (!report.options.record.empty()) json["recording"] = report.options.record;
  json["black_box"] = {{"path", report.options.black_box}, {"written", report.black_boxes}};
  json["devices"] = devices_json(report);
  json["assets"] = assets_json(report);
  return json;
}

std::string to_text(const RunReport& report) {
  const Totals totals = totals_of(report);
  const LoopCounters& counters = report.counters;
  const double in_contact = counters.ticks > 0
                                ? 100.0 * static_cast<double>(counters.contact_ticks) /
                                      static_cast<double>(counters.ticks)
                                : 0;
  std::string text = fmt::format(
      "{} ticks at {} Hz, {} missed, in contact {:.0f} % of them\n"
      "woke up late by {}\n"
      "worked for      {}\n"
      "page faults in the loop: {}; scheduling {} {}, memory {}locked, idle states {}\n"
      "largest force {:.3f} N, force cap met {} times, energy generated at most {:.3g} J\n",
      counters.ticks, report.options.rate_hz, counters.missed, in_contact,
      percentiles_text(report.wake_us), percentiles_text(report.busy_us), counters.page_faults,
      report.realtime.policy, report.realtime.priority, report.realtime.memory_locked ? "" : "not ",
      report.latency_held ? "held off" : "as usual", totals.force_max, totals.cap_hits,
      totals.generated_max);
  if (report.devices.size() > 1) {
    for (std::size_t i = 0; i < report.devices.size(); ++i) {
      text += device_text(i, report.devices[i]);
    }
  }
  text += turning_text(report);
  for (const DeviceReport& device : report.devices) {
    if (device.delay.counted > border_delay_ticks) {
      text += fmt::format("{}: forces came {:.2f} ticks late, counted as {:g}; felt at most {}\n",
                          device.capabilities.name, device.delay.measured, device.delay.counted,
                          format_quantity(device.delay.stiffest, Quantity::stiffness));
    }
    const auto warning = device.details.find("warning");
    if (warning == device.details.end()) continue;
    text += fmt::format("warning: {}: {}\n", device.capabilities.name, warning->get<std::string>());
  }
  if (counters.degraded_ticks > 0 && report.force.scene.tool) {
    text += fmt::format(
        "too little time for {} ticks: the tool was on a coarser level, or short of its balance\n",
        counters.degraded_ticks);
  } else if (counters.degraded_ticks > 0) {
    text += fmt::format(
        "too little time for {} ticks: {} answers of objects by the plane touched last, {} with "
        "fewer queries\n",
        counters.degraded_ticks, totals.held, totals.shortened);
  }
  const ForceOffTicks off = sum_force_off(report);
  for (std::size_t i = 0; i < force_off_count; ++i) {
    if (off[i] == 0) continue;
    const auto cause = static_cast<ForceOff>(i);
    text += fmt::format("force off for {} tick{}: {}\n", off[i], off[i] == 1 ? "" : "s",
                        to_string(cause));
  }
  return text;
}

}  // namespace spm::servo
