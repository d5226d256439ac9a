// SPDX-License-Identifier: Apache-2.0
#include "servo/devices/external/external_options.hpp"

#include <algorithm>
#include <cctype>

#include "servo/devices/base/option_list.hpp"

namespace spm::servo {

namespace {

constexpr char device[] = "external";

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
    } else {
      return option_error(device, "option '" + std::string(key) +
                                      "' is not known; the options are name and profile");
    }
  }
  if (!is_plain(options.name)) {
    return option_error(device,
                        "it needs a name of letters, digits, '-' and '_', by which the "
                        "device's process finds it; write external:name=NAME");
  }
  return options;
}

}  // namespace spm::servo
