// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <functional>
#include <string>
#include <string_view>
#include <vector>

#include "common/base/error.hpp"
#include "common/base/units.hpp"

namespace spm::servo {

/// One option of a device, from `--device NAME:key=value,key=value`.
struct DeviceOption {
  std::string_view key, value;
};

/// Splits a device's options, which refer to `text`. Errors: usage, for an option without a value.
[[nodiscard]] Result<std::vector<DeviceOption>> split_options(const std::string& device,
                                                              std::string_view text);

/// A usage error for a device's options.
[[nodiscard]] tl::unexpected<Error> option_error(const std::string& device,
                                                 const std::string& message);

/// Sets a quantity, SI, that must be above 0 and within the bounds. Errors: usage.
[[nodiscard]] Result<void> set_option_quantity(const std::string& device, double& target,
                                               std::string_view key, std::string_view value,
                                               Quantity quantity, double max, double min = 0);
/// Sets what is on or off. Errors: usage.
[[nodiscard]] Result<void> set_option_switch(const std::string& device, bool& target,
                                             std::string_view key, std::string_view value);
/// Sets the serial number that a device must have. Errors: usage, an empty one.
[[nodiscard]] Result<void> set_option_serial(const std::string& device, std::string& target,
                                             std::string_view value);

/// Calls `set` with the key and the value of each of a device's options. Errors: usage, those of
/// split_options; and the first of `set`.
[[nodiscard]] Result<void> set_options(
    const std::string& device, std::string_view text,
    const std::function<Result<void>(std::string_view key, std::string_view value)>& set);

}  // namespace spm::servo
