// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <functional>
#include <nlohmann/json.hpp>
#include <string>
#include <vector>

#include "servo/devices/finder/device_finder.hpp"
#include "servo/doctor/doctor_wakeup.hpp"
#include "servo/doctor/verdict.hpp"

namespace spm::servo {

/// What `doctor` found out about this machine.
struct Diagnosis {
  Verdict verdict = Verdict::unknown;  ///< whether the machine is fit for 1 kHz
  Wakeups wakeups;
  DeviceSearch search;
  std::vector<Check> checks;
};

/// Whether the machine is fit: what the wake-ups say, and at best fair without real-time priority,
/// because the next program that is busy then holds up the loop. The other checks explain the
/// wake-ups and do not count again.
[[nodiscard]] Verdict overall_verdict(Verdict wake_up, Verdict scheduling) noexcept;

/// Measures this machine for so many seconds and a few more. `progress` is told the share done, 0
/// to 1, a few times a second.
[[nodiscard]] Diagnosis diagnose(double seconds, const std::function<void(double)>& progress);

/// One object, for `doctor --json`.
[[nodiscard]] nlohmann::ordered_json to_json(const Diagnosis& diagnosis);

/// A line a check, with its cure below, and the verdict first.
[[nodiscard]] std::string to_text(const Diagnosis& diagnosis);

}  // namespace spm::servo
