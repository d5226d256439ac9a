// SPDX-License-Identifier: Apache-2.0
#include "servo/devices/spacemouse/spacemouse_options.hpp"

#include <fmt/format.h>

#include <charconv>
#include <cmath>

#include "common/base/units.hpp"
#include "servo/devices/base/option_list.hpp"

namespace spm::servo {

namespace {

tl::unexpected<Error> usage(const std::string& what) { return option_error("spacemouse", what); }

constexpr double fastest = 1;                          // m/s, as the simulated hand
constexpr double fastest_turn = 4 * std::numbers::pi;  // rad/s, two turns
constexpr double largest_box = 10;                     // m

Result<void> set_quantity(double& target, std::string_view key, std::string_view value,
                          Quantity quantity, double most) {
  return set_option_quantity("spacemouse", target, key, value, quantity, most);
}

Result<void> set_dead_zone(SpaceMouseOptions& options, std::string_view value) {
  double percent = 0;
  const char* end = value.data() + value.size();
  const auto parsed = std::from_chars(value.data(), end, percent);
  const std::string_view unit(parsed.ptr, static_cast<std::size_t>(end - parsed.ptr));
  if (parsed.ec != std::errc{} || unit != "%" || !(percent >= 0 && percent < 100)) {
    return usage(
        fmt::format("dead_zone '{}' is not a part such as 5%, from 0% to below 100%", value));
  }
  options.dead_zone = percent / 100;
  return {};
}

Result<void> set(SpaceMouseOptions& options, std::string_view key, std::string_view value) {
  if (key == "speed") return set_quantity(options.speed, key, value, Quantity::speed, fastest);
  if (key == "turn") {
    return set_quantity(options.turn, key, value, Quantity::angular_speed, fastest_turn);
  }
  if (key == "dead_zone") return set_dead_zone(options, value);
  if (key == "box") return set_quantity(options.box, key, value, Quantity::length, largest_box);
  if (key == "serial") return set_option_serial("spacemouse", options.serial, value);
  return usage(
      fmt::format("option '{}' is not known; the options are speed, turn, dead_zone, box "
                  "and serial",
                  key));
}

}  // namespace

Result<SpaceMouseOptions> parse_spacemouse_options(std::string_view text) {
  SpaceMouseOptions options;
  const auto done = set_options(
      "spacemouse", text,
      [&](std::string_view key, std::string_view value) { return set(options, key, value); });
  if (!done) return tl::make_unexpected(done.error());
  return options;
}

}  // namespace spm::servo
