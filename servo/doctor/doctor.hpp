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

/// The results of `doctor` on this machine.
struct Diagnosis {
  Verdict verdict = Verdict::unknown;  ///< whether the machine is fit for 1 kHz
  Wakeups wakeups;
  DeviceSearch search;
  std::vector<Check> checks;
};

/// Whether the machine is fit. This is the verdict on the wake-ups; without real-time priority it
/// is at best fair, because the next busy program then delays the loop. The other checks explain
/// the wake-ups and do not count again.
[[nodiscard]] Verdict overall_verdict(Verdict wake_up, Verdict scheduling) noexcept;

/// Measures this machine for `seconds`, and a few more. `progress` is called with the finished
/// fraction, 0 to 1, a few times a second.
[[nodiscard]] Diagnosis diagnose(double seconds, const std::function<void(double)>& progress);

/// One object, for `doctor --json`.
[[nodiscard]] nlohmann::ordered_json to_json(const Diagnosis& diagnosis);

/// The verdict first, then a line for each check, with its cure below.
[[nodiscard]] std::string to_text(const Diagnosis& diagnosis);

}  // namespace spm::servo
