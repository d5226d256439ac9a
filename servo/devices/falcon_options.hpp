// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>
#include <string_view>

#include "common/error.hpp"
#include "servo/devices/falcon_kinematics.hpp"

namespace spm::servo {

/// Options of a Novint Falcon: `falcon:firmware=FILE,path=BUS-PORT.PORT,force_cap=FORCE,
/// home_angle=ANGLE`.
struct FalconOptions {
  std::string firmware;                   ///< file; empty: none, the device must run one already
  std::string path;                       ///< USB path; empty: the first that is found
  double force_cap = 0;                   ///< N, above 0, at most that of the device's profile
  double home_angle = falcon_home_angle;  ///< rad, of a thigh whose encoder counts zero
};

/// Parses what follows `falcon:`; the empty text gives the defaults. The firmware's default is the
/// environment's FALCON_FIRMWARE. Errors: usage, an unknown key with the valid ones, a value out of
/// range.
[[nodiscard]] Result<FalconOptions> parse_falcon_options(std::string_view text);

}  // namespace spm::servo
