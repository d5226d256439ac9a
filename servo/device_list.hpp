// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <memory>
#include <string>

#include "servo/device.hpp"

namespace spm::servo {

/// Makes the device that a command line asks for, NAME or NAME:option=value,...; it is not open
/// yet. `auto` is the first device found, and the simulated one where there is none. Errors: usage.
[[nodiscard]] Result<std::unique_ptr<Device>> make_device(const std::string& specification);

}  // namespace spm::servo
