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
  std::string firmware;  ///< path of the file; empty: none, the device must run firmware already
  std::string path;      ///< USB path; empty: the first device that is found
  /// USB product id. Set it to another id than a Falcon's only if the chip lost the one it was
  /// given. It then appears as any other FTDI chip, 6001, and every such chip would be taken for a
  /// Falcon.
  std::uint16_t product = falcon_product;
  double force_cap = 0;                   ///< N, above 0, at most that of the device's profile
  double home_angle = falcon_home_angle;  ///< rad, of a thigh when its encoder counts zero
};

/// Parses the text after `falcon:`; the empty text gives the defaults. The default of the firmware
/// is the environment's FALCON_FIRMWARE. Errors: usage, for an unknown key, with the valid ones,
/// and for a value out of range.
[[nodiscard]] Result<FalconOptions> parse_falcon_options(std::string_view text);

}  // namespace spm::servo
