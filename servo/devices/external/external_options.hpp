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
};

/// Reads `name=NAME[,profile=PROFILE]`. Errors: usage.
[[nodiscard]] Result<ExternalOptions> parse_external_options(std::string_view text);

}  // namespace spm::servo
