// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <numbers>
#include <string>
#include <string_view>

#include "common/base/device_profile.hpp"
#include "common/base/error.hpp"

namespace spm::servo {

/// Options of a SpaceMouse: `spacemouse:speed=SPEED,turn=ANGULAR_SPEED,dead_zone=PERCENT,
/// box=LENGTH,serial=TEXT`.
struct SpaceMouseOptions {
  double speed = 0.1;                            ///< m/s at full deflection, above 0
  double turn = std::numbers::pi / 2;            ///< rad/s at full deflection, above 0
  double dead_zone = 0.05;                       ///< of full deflection, 0 to below 1
  double box = device_profiles[0].workspace[0];  ///< m, edge of the cube in which the tool stays
  std::string serial;                            ///< empty: any
};
static_assert(device_profiles[0].name == "low");

/// Parses the text after `spacemouse:`; the empty text gives the defaults. Errors: usage, for an
/// unknown key, with the valid ones, and for a value out of range.
[[nodiscard]] Result<SpaceMouseOptions> parse_spacemouse_options(std::string_view text);

}  // namespace spm::servo
