// SPDX-License-Identifier: Apache-2.0
#include "servo/devices/falcon/falcon_options.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <charconv>
#include <cstddef>
#include <cstdlib>

#include "common/base/device_profile.hpp"
#include "common/base/units.hpp"
#include "servo/devices/base/option_list.hpp"

namespace spm::servo {

namespace {

constexpr double profile_force_cap = find_device_profile("falcon")->force_cap;

// The range of a device's calibration around the approximate 35 degrees.
constexpr double min_home_angle = 25 * std::numbers::pi / 180;
constexpr double max_home_angle = 45 * std::numbers::pi / 180;

constexpr const char* device = "falcon";

tl::unexpected<Error> usage(const std::string& message) { return option_error(device, message); }

/// Removes a whole number from the front.
bool take_number(std::string_view& text) {
  const std::size_t digits = std::min(text.find_first_not_of("0123456789"), text.size());
  text.remove_prefix(digits);
  return digits >= 1 && digits <= 3;
}

bool take_mark(std::string_view& text, char mark) {
  if (text.empty() || text.front() != mark) return false;
  text.remove_prefix(1);
  return true;
}

/// BUS-PORT, followed by .PORT for each hub.
bool is_usb_path(std::string_view text) {
  if (!take_number(text) || !take_mark(text, '-') || !take_number(text)) return false;
  while (take_mark(text, '.')) {
    if (!take_number(text)) return false;
  }
  return text.empty();
}

Result<void> set_product(FalconOptions& options, std::string_view value) {
  constexpr std::size_t id_digits = 4;
  const char* const end = value.data() + value.size();
  std::uint16_t product = 0;
  const auto parsed = std::from_chars(value.data(), end, product, 16);
  if (value.size() != id_digits || parsed.ec != std::errc{} || parsed.ptr != end) {
    return usage(fmt::format(
        "product '{}' is no USB product id; write its four hexadecimal digits, as in product=6001, "
        "as lsusb shows them behind the colon",
        value));
  }
  options.product = product;
  return {};
}

Result<void> set_quantity(double& target, std::string_view key, std::string_view value,
                          Quantity quantity, double least, double most) {
  return set_option_quantity(device, target, key, value, quantity, most, least);
}

Result<void> set(FalconOptions& options, std::string_view key, std::string_view value) {
  if (key == "firmware") {
    if (value.empty()) return usage("firmware is empty; name the device's firmware file");
    options.firmware = value;
    return {};
  }
  if (key == "path") {
    if (!is_usb_path(value)) {
      return usage(fmt::format(
          "path '{}' is no USB path; write BUS-PORT.PORT, as in path=1-2.3, as lsusb -t shows it",
          value));
    }
    options.path = value;
    return {};
  }
  if (key == "product") return set_product(options, value);
  if (key == "force_cap") {
    return set_quantity(options.force_cap, key, value, Quantity::force, 0, profile_force_cap);
  }
  if (key == "home_angle") {
    return set_quantity(options.home_angle, key, value, Quantity::angle, min_home_angle,
                        max_home_angle);
  }
  return usage(fmt::format(
      "option '{}' is not known; the options are firmware, path, product, force_cap and home_angle",
      key));
}

}  // namespace

Result<FalconOptions> parse_falcon_options(std::string_view text) {
  FalconOptions options;
  options.force_cap = profile_force_cap;
  const auto done = set_options(device, text, [&](std::string_view key, std::string_view value) {
    return set(options, key, value);
  });
  if (!done) return tl::make_unexpected(done.error());
  if (options.firmware.empty()) {
    const char* const file = std::getenv("FALCON_FIRMWARE");
    if (file != nullptr) options.firmware = file;
  }
  return options;
}

}  // namespace spm::servo
