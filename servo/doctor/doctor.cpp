// SPDX-License-Identifier: Apache-2.0
#include "servo/doctor/doctor.hpp"

#include <fmt/format.h>

#include "servo/doctor/doctor_limits.hpp"
#include "servo/doctor/doctor_machine.hpp"
#include "servo/doctor/doctor_usb.hpp"
#include "servo/loop/run_report.hpp"

namespace spm::servo {

using nlohmann::ordered_json;

namespace {

const char* answer_of(Verdict verdict) noexcept {
  switch (verdict) {
    case Verdict::good:
      return "yes, as it is";
    case Verdict::fair:
      return "mostly, but a tick will be late now and then; the cures below help";
    case Verdict::poor:
      return "no, ticks will be late or missed; the cures below help";
    case Verdict::unknown:
      break;
  }
  return "not known";
}

ordered_json wake_late_json(const Wakeups& wakeups) {
  return {{"us_200", wakeups.late_200us},
          {"us_500", wakeups.late_500us},
          {"us_1000", wakeups.late_1ms},
          {"skipped", wakeups.skipped}};
}

ordered_json checks_json(const std::vector<Check>& checks) {
  ordered_json list = ordered_json::array();
  for (const Check& check : checks) {
    list.push_back({{"name", check.name},
                    {"verdict", to_string(check.verdict)},
                    {"measured", check.measured},
                    {"cure", check.cure.empty() ? ordered_json() : ordered_json(check.cure)}});
  }
  return list;
}

}  // namespace

Verdict overall_verdict(Verdict wake_up, Verdict scheduling) noexcept {
  if (wake_up == Verdict::unknown || wake_up == Verdict::poor) return wake_up;
  return scheduling == Verdict::good ? wake_up : Verdict::fair;
}

Diagnosis diagnose(double seconds, const std::function<void(double)>& progress) {
  Diagnosis diagnosis;
  const MachineFacts facts = read_machine();
  const ProcessLimits limits = read_process_limits();
  diagnosis.search = find_devices();
  const std::vector<RoundTrips> trips = measure_round_trips(diagnosis.search.devices);
  // Last, because it locks the process's memory.
  diagnosis.wakeups = measure_wakeups(seconds, progress);
  const RealtimeState& realtime = diagnosis.wakeups.realtime;
  const Check wake_up = judge_wakeups(diagnosis.wakeups);
  const Check scheduling = judge_scheduling(realtime, limits);
  diagnosis.verdict = overall_verdict(wake_up.verdict, scheduling.verdict);
  diagnosis.checks = {wake_up,
                      scheduling,
                      judge_memory_lock(realtime, limits),
                      judge_throttling(facts),
                      judge_cgroup(facts),
                      judge_governor(facts),
                      judge_idle(facts),
                      judge_latency(facts),
                      judge_interrupts(facts),
                      judge_kernel(facts),
                      judge_virtual(facts),
                      judge_processors(facts),
                      judge_devices(diagnosis.search),
                      judge_round_trips(trips)};
  return diagnosis;
}

ordered_json to_json(const Diagnosis& diagnosis) {
  const Wakeups& wakeups = diagnosis.wakeups;
  ordered_json devices = ordered_json::array();
  for (const FoundDevice& device : diagnosis.search.devices) devices.push_back(to_json(device));
  return {{"verdict", to_string(diagnosis.verdict)},
          {"rate_hz", doctor_rate_hz},
          {"seconds", wakeups.seconds},
          {"ticks", wakeups.ticks},
          {"wake_us", percentiles_json(wakeups.us)},
          {"wake_late", wake_late_json(wakeups)},
          {"realtime",
           {{"policy", wakeups.realtime.policy},
            {"priority", wakeups.realtime.priority},
            {"memory_locked", wakeups.realtime.memory_locked}}},
          {"checks", checks_json(diagnosis.checks)},
          {"devices", std::move(devices)}};
}

std::string to_text(const Diagnosis& diagnosis) {
  std::string text =
      fmt::format("Is this machine fit for a loop at {:.0f} Hz? {}: {}.\n\n", doctor_rate_hz,
                  to_string(diagnosis.verdict), answer_of(diagnosis.verdict));
  for (const Check& check : diagnosis.checks) {
    text += fmt::format("{:<8} {:<15} {}\n", to_string(check.verdict), check.name, check.measured);
    if (!check.cure.empty()) text += fmt::format("{:<24} cure: {}\n", "", check.cure);
  }
  return text;
}

}  // namespace spm::servo
