// SPDX-License-Identifier: Apache-2.0
#include "servo/devices/sim/sim_options.hpp"

#include <fmt/format.h>

#include <charconv>

#include "common/units.hpp"
#include "servo/devices/option_list.hpp"
#include "servo/devices/sim/hand_motion.hpp"

namespace spm::servo {

namespace {

constexpr double deepest = 0.1;  // m

tl::unexpected<Error> usage(const std::string& message) { return option_error("sim", message); }

Result<void> set_profile(SimOptions& options, std::string_view value) {
  options.profile = find_sim_profile(value);
  if (options.profile != nullptr) return {};
  return usage(
      fmt::format("profile '{}' is not known; the profiles are{}", value, device_profile_names()));
}

Result<void> set_hand(SimOptions& options, std::string_view value) {
  if (value == "slide") {
    options.hand = HandKind::slide;
  } else if (value == "push") {
    options.hand = HandKind::push;
  } else if (value == "path") {
    options.hand = HandKind::recorded;
  } else {
    return usage(fmt::format("hand '{}' is not known; a hand can slide, push or path", value));
  }
  return {};
}

Result<void> set_quantity(double& target, std::string_view key, std::string_view value,
                          Quantity quantity, double most) {
  return set_option_quantity("sim", target, key, value, quantity, most);
}

Result<void> set_seed(SimOptions& options, std::string_view value) {
  const char* end = value.data() + value.size();
  const auto parsed = std::from_chars(value.data(), end, options.seed);
  if (parsed.ec == std::errc{} && parsed.ptr == end && !value.empty()) return {};
  return usage(fmt::format("seed '{}' is not a whole number from 0", value));
}

Result<void> set(SimOptions& options, std::string_view key, std::string_view value) {
  if (key == "profile") return set_profile(options, value);
  if (key == "hand") return set_hand(options, value);
  if (key == "depth") {
    return set_quantity(options.depth, key, value, Quantity::length, deepest);
  }
  if (key == "speed") {
    return set_quantity(options.speed, key, value, Quantity::speed, fastest_target);
  }
  if (key == "seed") return set_seed(options, value);
  if (key == "path") {
    if (value.empty()) return usage("path is empty; name a trajectory file");
    options.path = value;
    return {};
  }
  return usage(fmt::format(
      "option '{}' is not known; the options are profile, hand, path, depth, speed and seed", key));
}

}  // namespace

Result<SimOptions> parse_sim_options(std::string_view text) {
  SimOptions options;
  bool hand_given = false;
  const auto list = split_options("sim", text);
  if (!list) return tl::make_unexpected(list.error());
  for (const auto& [key, value] : *list) {
    const Result<void> done = set(options, key, value);
    if (!done) return tl::make_unexpected(done.error());
    hand_given = hand_given || key == "hand";
  }
  if (!options.path.empty() && !hand_given) options.hand = HandKind::recorded;
  if (options.hand == HandKind::recorded && options.path.empty()) {
    return usage("hand=path needs path=FILE, a trajectory with one row a tick");
  }
  if (options.hand != HandKind::recorded && !options.path.empty()) {
    return usage("path=FILE goes with hand=path only");
  }
  return options;
}

}  // namespace spm::servo
