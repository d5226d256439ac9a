// SPDX-License-Identifier: Apache-2.0
#include "servo/devices/pid/pid_options.hpp"

#include <fmt/format.h>

#include <algorithm>

#include "common/base/device_profile.hpp"
#include "common/base/units.hpp"
#include "servo/devices/base/option_list.hpp"

namespace spm::servo {

namespace {

/// N, far above any stick; the rim of a wheel is not stronger either.
constexpr double largest_full_force = 500;  // N
constexpr double largest_travel = 1;        // m

/// No haptic device may exceed this, whoever made it.
constexpr double strongest_cap = device_profiles[0].force_cap;
static_assert(device_profiles[0].name == "low");

tl::unexpected<Error> usage(const std::string& what) { return option_error("pid", what); }

Result<void> set_signs(PidOptions& options, std::string_view value) {
  if (value.size() != 2 || value.find_first_not_of("+-") != std::string_view::npos) {
    return usage(fmt::format("force_signs '{}' is not one + or - for each of x and y", value));
  }
  for (std::size_t i = 0; i < 2; ++i) options.force_signs[i] = value[i] == '+' ? 1 : -1;
  return {};
}

Result<void> set_direction(PidOptions& options, std::string_view value) {
  options.direction = find_pid_direction(value);
  if (options.direction) return {};
  return usage(
      fmt::format("direction '{}' is not known; it can be polar, cartesian or axes", value));
}

Result<void> set_watchdog(PidOptions& options, std::string_view value) {
  if (value != "on" && value != "off") {
    return usage(fmt::format("watchdog '{}' is not known; it can be on or off", value));
  }
  options.watchdog = value == "on";
  return {};
}

Result<void> set_serial(PidOptions& options, std::string_view value) {
  if (value.empty()) return usage("serial is empty; write what spm-servo devices shows");
  options.serial = value;
  return {};
}

Result<void> set(PidOptions& options, std::string_view key, std::string_view value) {
  if (key == "full_force") {
    return set_option_quantity("pid", options.full_force, key, value, Quantity::force,
                               largest_full_force);
  }
  if (key == "force_cap") {
    return set_option_quantity("pid", options.force_cap, key, value, Quantity::force,
                               strongest_cap);
  }
  if (key == "travel") {
    return set_option_quantity("pid", options.travel, key, value, Quantity::length, largest_travel);
  }
  if (key == "force_signs") return set_signs(options, value);
  if (key == "direction") return set_direction(options, value);
  if (key == "watchdog") return set_watchdog(options, value);
  if (key == "serial") return set_serial(options, value);
  return usage(
      fmt::format("option '{}' is not known; the options are full_force, force_cap, travel, "
                  "force_signs, direction, watchdog and serial",
                  key));
}

}  // namespace

Result<PidOptions> parse_pid_options(std::string_view text) {
  PidOptions options;
  const auto list = split_options("pid", text);
  if (!list) return tl::make_unexpected(list.error());
  for (const auto& [key, value] : *list) {
    const Result<void> done = set(options, key, value);
    if (!done) return tl::make_unexpected(done.error());
  }
  if (!(options.full_force > 0)) {
    return usage(
        "full_force is missing, the force at the grip at the device's full strength, which it "
        "does not tell; measure it with a spring scale, and write it as full_force=8N");
  }
  if (options.force_cap > options.full_force) {
    return usage(fmt::format("force_cap {} is above full_force {}, which the device cannot exceed",
                             format_quantity(options.force_cap, Quantity::force),
                             format_quantity(options.full_force, Quantity::force)));
  }
  if (!(options.force_cap > 0)) options.force_cap = std::min(options.full_force, strongest_cap);
  return options;
}

}  // namespace spm::servo
