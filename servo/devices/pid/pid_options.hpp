// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <optional>
#include <string>
#include <string_view>

#include "common/base/error.hpp"
#include "servo/devices/pid/pid_layout.hpp"

namespace spm::servo {

/// Options of a force feedback device of the HID PID class: `pid:full_force=FORCE,force_cap=FORCE,
/// travel=LENGTH,force_signs=++,direction=polar|cartesian|axes,watchdog=on|off,serial=TEXT`.
struct PidOptions {
  double full_force = 0;  ///< N at the grip at full magnitude; no descriptor gives it
  double force_cap = 0;   ///< N, above 0, at most full_force and the strongest profile's
  double travel = 0.1;    ///< m, of the grip from stop to stop, for each axis
  std::array<double, 2> force_signs{1, 1};  ///< +1 or -1: -1 if it pushes the other way
  std::optional<PidDirection> direction;    ///< empty: as the descriptor has it
  bool watchdog = true;  ///< whether effects end by themselves unless they are renewed
  std::string serial;    ///< empty: any
  std::string path;      ///< its node, for who knows it already; empty: any
};

/// Parses the text after `pid:`. Errors: usage, for an unknown key or word, with the valid ones, a
/// value out of range, and no full_force.
[[nodiscard]] Result<PidOptions> parse_pid_options(std::string_view text);

}  // namespace spm::servo
