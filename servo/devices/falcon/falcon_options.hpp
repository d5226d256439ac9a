// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <string>
#include <string_view>

#include "common/base/error.hpp"
#include "servo/devices/falcon/falcon_kinematics.hpp"
#include "servo/devices/falcon/falcon_usb.hpp"

namespace spm::servo {

/// Options of a Novint Falcon: `falcon:firmware=FILE,path=BUS-PORT.PORT,product=ID,force_cap=FORCE,
/// home_angle=ANGLE`.
struct FalconOptions {
  std::string firmware;  ///< file; empty: none, the device must run one already
  std::string path;      ///< USB path; empty: the first that is found
  /// USB product id. Another than a Falcon's only where its chip lost the one it was given: it then
  /// shows itself as any other FTDI chip, 6001, and every such chip would be taken for a Falcon.
  std::uint16_t product = falcon_product;
  double force_cap = 0;                   ///< N, above 0, at most that of the device's profile
  double home_angle = falcon_home_angle;  ///< rad, of a thigh whose encoder counts zero
};

/// Parses what follows `falcon:`; the empty text gives the defaults. The firmware's default is the
/// environment's FALCON_FIRMWARE. Errors: usage, an unknown key with the valid ones, a value out of
/// range.
[[nodiscard]] Result<FalconOptions> parse_falcon_options(std::string_view text);

}  // namespace spm::servo
