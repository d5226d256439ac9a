// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>
#include <string_view>

#include "common/base/device_profile.hpp"
#include "common/base/error.hpp"

namespace spm::servo {

struct ExternalOptions {
  std::string name;                                             ///< letters, digits, '-' and '_'
  const DeviceProfile* profile = find_device_profile("touch");  ///< the weakest: its cap holds
  bool turns = true;      ///< its process tells the orientation of the tool
  double torque_cap = 0;  ///< N m, the largest torque that its motors bear; 0: it has none
};

/// Reads `name=NAME[,profile=PROFILE][,turns=on|off][,torque_cap=TORQUE]`. Errors: usage.
[[nodiscard]] Result<ExternalOptions> parse_external_options(std::string_view text);

}  // namespace spm::servo
