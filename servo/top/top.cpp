// SPDX-License-Identifier: Apache-2.0
#include "servo/top/top.hpp"

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <nlohmann/json.hpp>

#include "servo/shared/shared_buckets.hpp"

namespace spm::servo {

using nlohmann::ordered_json;

namespace {

constexpr double seconds_per_ns = 1e-9;
constexpr double us_per_ns = 1e-3;

TopCount count_of(std::uint64_t before, std::uint64_t now) noexcept { return {now - before, now}; }

double size_of(const double (&vector)[3]) noexcept {
  return std::hypot(vector[0], vector[1], vector[2]);
}

TopTool tool_between(const TopSample::Device& before, const TopSample::Device& now) {
  TopTool tool;
  tool.is_there = now.state.has_tool != 0;
  std::copy(std::begin(now.state.tool_position), std::end(now.state.tool_position),
            tool.position.begin());
  std::copy(std::begin(now.state.tool_orientation), std::end(now.state.tool_orientation),
            tool.orientation.begin());
  tool.contacts = now.state.contact_count;
  tool.level = now.state.level;
  tool.culled = now.state.culled;
  tool.capped = (now.state.limits & SPM_CLIENT_TOOL_CAP_MET) != 0;
  tool.cap_hits = count_of(before.counts.tool_cap_hits, now.counts.tool_cap_hits);
  return tool;
}

TopDevice device_between(const TopSample::Device& before, const TopSample::Device& now) {
  TopDevice device;
  device.name = now.name;
  device.connected = now.state.connected != 0;
  device.contact = now.state.contact != 0;
  device.contacts = now.state.contacts;
  device.force = size_of(now.state.force);
  // The counts are published a tick after the state.
  device.force_max = std::max(now.counts.force_max, device.force);
  device.cap_hits = count_of(before.counts.cap_hits, now.counts.cap_hits);
  device.slew_hits = count_of(before.counts.slew_hits, now.counts.slew_hits);
  device.torque = size_of(now.state.torque);
  device.torque_max = std::max(now.counts.torque_max, device.torque);
  device.torque_cap = now.state.torque_cap;
  device.torque_cap_hits = count_of(before.counts.torque_cap_hits, now.counts.torque_cap_hits);
  device.torque_slew_hits = count_of(before.counts.torque_slew_hits, now.counts.torque_slew_hits);
  device.tool = tool_between(before, now);
  device.energy = now.counts.energy;
  device.generated_max = now.counts.generated_max;
  device.off = now.state.cause != SPM_CLIENT_FORCE_ON;
  device.cuts = count_of(before.state.cuts, now.state.cuts);
  // Before the first cut there was no force yet, without any fault.
  if (!device.off && now.state.cuts == 0) return device;
  device.cause = now.cause;
  device.cure = now.cure;
  return device;
}

const char* name_of(int daemon) noexcept {
  switch (daemon) {
    case SPM_CLIENT_RUNNING:
      return "running";
    case SPM_CLIENT_ENDED:
      return "ended";
    case SPM_CLIENT_GONE:
      return "gone";
    default:
      return "stalled";
  }
}

ordered_json to_json(const TopTimes& times) {
  return {{"p50", times.p50}, {"p99", times.p99}, {"max", times.max}};
}

ordered_json to_json(const TopCount& count) {
  return {{"recent", count.recent}, {"total", count.total}};
}

ordered_json to_json(const TopTool& tool) {
  return {{"position_m", tool.position},
          {"orientation", tool.orientation},
          {"contacts", tool.contacts},
          {"level", tool.level},
          {"culled", tool.culled},
          {"capped", tool.capped},
          {"cap_hits", to_json(tool.cap_hits)}};
}

ordered_json to_json(const TopDevice& device) {
  ordered_json json = {
      {"name", device.name},
      {"connected", device.connected},
      {"contact", device.contact},
      {"contacts", device.contacts},
      {"force_n", {{"now", device.force}, {"max", device.force_max}}},
      {"cap_hits", to_json(device.cap_hits)},
      {"slew_hits", to_json(device.slew_hits)},
      {"torque_n_m", {{"now", device.torque}, {"max", device.torque_max}, {"cap", nullptr}}},
      {"torque_cap_hits", to_json(device.torque_cap_hits)},
      {"torque_slew_hits", to_json(device.torque_slew_hits)},
      {"tool", device.tool.is_there ? to_json(device.tool) : ordered_json(nullptr)},
      {"energy_j", {{"now", device.energy}, {"generated_max", device.generated_max}}},
      {"cuts", to_json(device.cuts)},
      {"force_off", nullptr},
      {"last_force_off", nullptr}};
  if (std::isfinite(device.torque_cap)) json["torque_n_m"]["cap"] = device.torque_cap;
  if (!device.cause.empty()) {
    json[device.off ? "force_off" : "last_force_off"] = {{"cause", device.cause},
                                                         {"cure", device.cure}};
  }
  return json;
}

}  // namespace

TopTimes times_between(const std::uint64_t (&before)[64], const std::uint64_t (&now)[64],
                       std::uint64_t longest_before, std::uint64_t longest) {
  std::uint64_t count = 0;
  for (std::size_t i = 0; i < std::size(now); ++i) count += now[i] - before[i];
  if (count == 0) return {};
  const auto length_of = [&](std::size_t bucket) {
    // The last bucket has no upper end.
    const std::uint64_t end = bucket + 1 < std::size(now) ? bucket_end_ns(bucket) : longest;
    return static_cast<double>(std::min(end, longest)) * us_per_ns;
  };
  const auto at = [&](double share) {
    const std::uint64_t rank = nearest_rank(share, count);
    std::uint64_t seen = 0;
    std::size_t bucket = 0;
    while (bucket + 1 < std::size(now)) {
      seen += now[bucket] - before[bucket];
      if (seen >= rank) break;
      ++bucket;
    }
    return length_of(bucket);
  };
  const double exact = static_cast<double>(longest) * us_per_ns;
  return {at(0.5), at(0.99), longest > longest_before ? exact : at(1)};
}

TopView view_between(const TopSample& before, const TopSample& now) {
  TopView view;
  view.daemon = now.daemon;
  view.age = now.age;
  view.version = now.info.daemon_version;
  view.process = now.info.process;
  view.wanted_rate_hz = now.info.rate_hz;
  const spm_client_loop &from = before.loop, &to = now.loop;
  // Before the first tick there is no time to start from.
  if (from.ticks > 0 && to.time_ns > from.time_ns) {
    view.seconds = static_cast<double>(to.time_ns - from.time_ns) * seconds_per_ns;
    view.rate_hz = static_cast<double>(to.ticks - from.ticks) / view.seconds;
    const double worked = static_cast<double>(to.busy_ns - from.busy_ns) * seconds_per_ns;
    view.busy_share = worked / view.seconds;
  }
  view.wake = times_between(from.wake, to.wake, from.wake_max_ns, to.wake_max_ns);
  view.busy = times_between(from.busy, to.busy, from.busy_max_ns, to.busy_max_ns);
  view.ticks = to.ticks;
  view.missed = count_of(from.missed, to.missed);
  view.skipped = count_of(from.skipped, to.skipped);
  view.degraded = count_of(from.degraded, to.degraded);
  view.coarse = count_of(from.coarse, to.coarse);
  for (std::size_t i = 0; i < now.devices.size(); ++i) {
    const bool known = i < before.devices.size();
    view.devices.push_back(
        device_between(known ? before.devices[i] : TopSample::Device{}, now.devices[i]));
  }
  view.applications = now.applications;
  view.commands = to.taken;
  view.refused = to.refused;
  view.garbage = to.garbage;
  return view;
}

const char* name_of_role(std::uint32_t role) noexcept {
  return role == SPM_CLIENT_SUPERVISOR ? "supervisor"
         : role == SPM_CLIENT_OBSERVER ? "observer"
                                       : "application";
}

ordered_json to_json(const TopView& view) {
  ordered_json devices = ordered_json::array();
  for (const TopDevice& device : view.devices) devices.push_back(to_json(device));
  ordered_json applications = ordered_json::array();
  for (const spm_client_application& application : view.applications) {
    applications.push_back({{"name", application.name},
                            {"process", application.process},
                            {"role", name_of_role(application.role)}});
  }
  ordered_json json = {
      {"daemon", name_of(view.daemon)},
      {"daemon_version", view.version},
      {"process", view.process},
      {"age_s", nullptr},
      {"seconds", view.seconds},
      {"rate_hz", view.rate_hz},
      {"wanted_rate_hz", view.wanted_rate_hz},
      {"ticks", view.ticks},
      {"missed", to_json(view.missed)},
      {"skipped", to_json(view.skipped)},
      {"degraded_ticks", to_json(view.degraded)},
      {"coarse_ticks", to_json(view.coarse)},
      {"wake_us", to_json(view.wake)},
      {"busy_us", to_json(view.busy)},
      {"busy_share", view.busy_share},
      {"devices", std::move(devices)},
      {"applications", std::move(applications)},
      {"commands",
       {{"taken", view.commands}, {"refused", view.refused}, {"garbage", view.garbage}}}};
  if (view.age >= 0) json["age_s"] = view.age;
  return json;
}

}  // namespace spm::servo
