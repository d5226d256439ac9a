// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>

#include "servo/safety/safety.hpp"

namespace spm::servo {

/// What the loop counted for one device.
struct DeviceCounters {
  std::uint64_t contact_ticks = 0;
  std::uint64_t cap_hits = 0;
  std::uint64_t slew_hits = 0;
  double force_max = 0;       ///< N, as sent
  double energy = 0;          ///< J, net work on the hand of what was sent: sum of F . dx + T . dr
  double generated_max = 0;   ///< J, largest positive value of `energy`
  ForceOffTicks force_off{};  ///< indexed by ForceOff
  std::uint64_t degraded_ticks = 0;  ///< in which `held` or `shortened` grew
  std::uint64_t held = 0;            ///< answers of objects, by Care
  std::uint64_t shortened = 0;       ///< answers of objects, by Care
  std::uint64_t coarse = 0;          ///< ticks at a coarser level of the tool's samples
  std::uint64_t torque_cap_hits = 0;
  std::uint64_t torque_slew_hits = 0;
  std::uint64_t tool_cap_hits = 0;  ///< in which the coupling of hand and tool met its cap
  std::uint64_t tool_leaving = 0;   ///< in which the tool was led out of what it lay in
  double torque_max = 0;            ///< N m, as sent
};

}  // namespace spm::servo
