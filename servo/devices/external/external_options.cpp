// SPDX-License-Identifier: Apache-2.0
#include "servo/devices/external/external_options.hpp"

#include <algorithm>
#include <cctype>

#include "servo/devices/base/option_list.hpp"

namespace spm::servo {

namespace {

constexpr char device[] = "external";
constexpr double strongest_torque = 10;  // N m; no hand device has as much

/// A name becomes part of a path, so it must be plain.
bool is_plain(std::string_view name) noexcept {
  return !name.empty() && std::all_of(name.begin(), name.end(), [](unsigned char letter) {
    return (std::isalnum(letter) != 0 && letter < 128) || letter == '-' || letter == '_';
  });
}

}  // namespace

Result<ExternalOptions> parse_external_options(std::string_view text) {
  const auto list = split_options(device, text);
  if (!list) return tl::make_unexpected(list.error());
  ExternalOptions options;
  for (const auto& [key, value] : *list) {
    if (key == "name") {
      options.name = value;
    } else if (key == "profile") {
      options.profile = find_device_profile(value);
      if (options.profile == nullptr) {
        return option_error(device, "profile '" + std::string(value) +
                                        "' is not known; the profiles are" +
                                        device_profile_names());
      }
    } else if (key == "turns") {
      auto done = set_option_switch(device, options.turns, key, value);
      if (!done) return tl::make_unexpected(std::move(done.error()));
    } else if (key == "torque_cap") {
      auto done = set_option_quantity(device, options.torque_cap, key, value, Quantity::torque,
                                      strongest_torque);
      if (!done) return tl::make_unexpected(std::move(done.error()));
    } else {
      return option_error(device, "option '" + std::string(key) +
                                      "' is not known; the options are name, profile, turns and "
                                      "torque_cap");
    }
  }
  if (options.torque_cap > 0 && !options.turns) {
    return option_error(device,
                        "torque_cap is of a device that tells its orientation; leave "
                        "turns=off out");
  }
  if (!is_plain(options.name)) {
    return option_error(device,
                        "it needs a name of letters, digits, '-' and '_', by which the "
                        "device's process finds it; write external:name=NAME");
  }
  return options;
}

}  // namespace spm::servo
