// SPDX-License-Identifier: Apache-2.0
#include "servo/devices/sim/sim_options.hpp"

#include <fmt/format.h>

#include <array>
#include <charconv>

#include "common/base/units.hpp"
#include "servo/devices/base/option_list.hpp"
#include "servo/devices/sim/actuator_line.hpp"
#include "servo/devices/sim/pose_motion.hpp"

namespace spm::servo {

namespace {

constexpr double deepest = 0.1;    // m
constexpr double noisiest = 1e-3;  // m

/// An option that is a number without a unit.
struct SimNumber {
  std::string_view key, unit;
  double SimOptions::*target;
  double most;
};

constexpr std::array<SimNumber, 3> numbers{
    {{"delay", "ticks", &SimOptions::delay_ticks, longest_delay},
     {"jitter", "ticks", &SimOptions::jitter_ticks, longest_delay},
     {"lost", "shares of the ticks", &SimOptions::lost_share, 1}}};

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
  } else if (value == "live") {
    options.hand = HandKind::live;
  } else {
    return usage(
        fmt::format("hand '{}' is not known; a hand can slide, push, path or live", value));
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

Result<void> set_hand_model(SimOptions& options, std::string_view value) {
  if (value == "spring") {
    options.hand_model = HandModel::spring;
  } else if (value == "arm") {
    options.hand_model = HandModel::arm;
  } else {
    return usage(fmt::format("hand_model '{}' is not known; it is spring or arm", value));
  }
  return {};
}

/// Sets a number without a unit, from 0 to the option's maximum.
Result<void> set_number(double& target, const SimNumber& option, std::string_view value) {
  double number = 0;
  const char* end = value.data() + value.size();
  const auto parsed = std::from_chars(value.data(), end, number);
  if (parsed.ec == std::errc{} && parsed.ptr == end && number >= 0 && number <= option.most) {
    target = number;
    return {};
  }
  return usage(fmt::format("{} '{}' is not a number of {} from 0 to {}", option.key, value,
                           option.unit, option.most));
}

/// `device` needs the profile, which may come later in the text, so it is looked up at the end.
Result<void> set_mass(bool& of_device, std::string_view value) {
  if (value != "constant" && value != "device") {
    return usage(fmt::format("mass '{}' is not known; it is constant or device", value));
  }
  of_device = value == "device";
  return {};
}

Result<void> set_switch(std::optional<bool>& target, std::string_view key, std::string_view value) {
  bool on = false;
  auto done = set_option_switch("sim", on, key, value);
  if (done) target = on;
  return done;
}

Result<void> set(SimOptions& options, bool& mass_of_device, std::string_view key,
                 std::string_view value) {
  if (key == "profile") return set_profile(options, value);
  if (key == "hand") return set_hand(options, value);
  if (key == "depth") {
    return set_quantity(options.depth, key, value, Quantity::length, deepest);
  }
  if (key == "speed") {
    return set_quantity(options.speed, key, value, Quantity::speed, fastest_target);
  }
  if (key == "seed") return set_seed(options, value);
  if (key == "hand_model") return set_hand_model(options, value);
  if (key == "turns") return set_switch(options.turns, key, value);
  if (key == "torque") return set_switch(options.torque, key, value);
  if (key == "mass") return set_mass(mass_of_device, value);
  if (key == "noise") return set_quantity(options.noise, key, value, Quantity::length, noisiest);
  for (const SimNumber& option : numbers) {
    if (key == option.key) return set_number(options.*option.target, option, value);
  }
  if (key == "path") {
    if (value.empty()) return usage("path is empty; name a trajectory file");
    options.path = value;
    return {};
  }
  return usage(
      fmt::format("option '{}' is not known; the options are profile, hand, path, depth, speed, "
                  "seed, hand_model, mass, "
                  "delay, jitter, lost, noise, turns and torque",
                  key));
}

}  // namespace

Result<SimOptions> parse_sim_options(std::string_view text) {
  SimOptions options;
  bool hand_given = false;
  bool mass_of_device = false;
  const auto done = set_options("sim", text, [&](std::string_view key, std::string_view value) {
    hand_given = hand_given || key == "hand";
    return set(options, mass_of_device, key, value);
  });
  if (!done) return tl::make_unexpected(done.error());
  if (!options.path.empty() && !hand_given) options.hand = HandKind::recorded;
  if (options.hand == HandKind::recorded && options.path.empty()) {
    return usage("hand=path needs path=FILE, a trajectory with one row a tick");
  }
  if (options.hand != HandKind::recorded && !options.path.empty()) {
    return usage("path=FILE goes with hand=path only");
  }
  if (options.torque == true && options.turns == false) {
    return usage("torque=on goes with a device that turns; leave turns=off out");
  }
  if (mass_of_device && options.turns == true) {
    return usage("mass=device is known of a device that does not turn alone; leave turns=on out");
  }
  if (mass_of_device) {
    options.turns = false;
    const auto mass = moving_mass_of(options.profile->name);
    if (!mass) {
      return usage(
          fmt::format("mass=device: the kinematics of profile '{}' are not known; those of falcon "
                      "and wooden are",
                      options.profile->name));
    }
    options.mass = *mass;
  }
  return options;
}

}  // namespace spm::servo
