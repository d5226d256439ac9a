// SPDX-License-Identifier: Apache-2.0
#include "servo/devices/base/option_list.hpp"

#include <fmt/format.h>

namespace spm::servo {

tl::unexpected<Error> option_error(const std::string& device, const std::string& message) {
  return fail(ExitCode::usage, fmt::format("--device {}: {}", device, message));
}

Result<std::vector<DeviceOption>> split_options(const std::string& device, std::string_view text) {
  std::vector<DeviceOption> options;
  while (!text.empty()) {
    const std::size_t comma = text.find(',');
    const std::string_view item = text.substr(0, comma);
    text = comma == std::string_view::npos ? std::string_view() : text.substr(comma + 1);
    const std::size_t equals = item.find('=');
    if (equals == std::string_view::npos) {
      return option_error(
          device, fmt::format("'{}' has no value; write option=value, separated by commas", item));
    }
    options.push_back({item.substr(0, equals), item.substr(equals + 1)});
  }
  return options;
}

Result<void> set_option_quantity(const std::string& device, double& target, std::string_view key,
                                 std::string_view value, Quantity quantity, double max,
                                 double min) {
  const Result<double> parsed = parse_quantity(value, quantity);
  if (!parsed) return option_error(device, fmt::format("{}: {}", key, parsed.error().message));
  if (!(*parsed > 0 && *parsed >= min && *parsed <= max)) {
    const std::string low = min > 0 ? "at least " + format_quantity(min, quantity) : "above 0";
    return option_error(device, fmt::format("{} {} is out of range; it must be {} and at most {}",
                                            key, value, low, format_quantity(max, quantity)));
  }
  target = *parsed;
  return {};
}

Result<void> set_option_switch(const std::string& device, bool& target, std::string_view key,
                               std::string_view value) {
  if (value != "on" && value != "off") {
    return option_error(device,
                        fmt::format("{} '{}' is not known; it can be on or off", key, value));
  }
  target = value == "on";
  return {};
}

Result<void> set_option_serial(const std::string& device, std::string& target,
                               std::string_view value) {
  if (value.empty()) {
    return option_error(device, "serial is empty; write what spm-servo devices shows");
  }
  target = value;
  return {};
}

Result<void> set_options(
    const std::string& device, std::string_view text,
    const std::function<Result<void>(std::string_view key, std::string_view value)>& set) {
  const auto list = split_options(device, text);
  if (!list) return tl::make_unexpected(list.error());
  for (const auto& [key, value] : *list) {
    Result<void> done = set(key, value);
    if (!done) return done;
  }
  return {};
}

}  // namespace spm::servo
