// SPDX-License-Identifier: Apache-2.0
#include "servo/devices/wooden/wooden_options.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <charconv>
#include <cmath>

#include "common/base/device_profile.hpp"
#include "common/base/units.hpp"
#include "servo/devices/base/option_list.hpp"

namespace spm::servo {

namespace {

/// A, of the strongest drives that were built in.
constexpr double largest_current = 6;

/// A counter has 16 bits.
constexpr int max_counts = 32767;

tl::unexpected<Error> usage(const std::string& what) { return option_error("woodenhaptics", what); }

Result<void> set_model(WoodenOptions& options, std::string_view value) {
  const WoodenModel* model = find_wooden_model(value);
  if (model == nullptr) {
    return usage(
        fmt::format("model '{}' is not known; the models are{}", value, wooden_model_names()));
  }
  options.model = model;
  return {};
}

Result<void> set_protocol(WoodenOptions& options, std::string_view value) {
  options.protocol.reset();
  if (value == "auto") return {};
  for (const WoodenProtocol protocol :
       {WoodenProtocol::v1, WoodenProtocol::v2, WoodenProtocol::v3}) {
    if (value != to_string(protocol)) continue;
    options.protocol = protocol;
    return {};
  }
  return usage(fmt::format("protocol '{}' is not known; it can be auto, v1, v2 or v3", value));
}

Result<void> read_signs(double* signs, std::string_view key, std::string_view value) {
  for (std::size_t i = 0; i < value.size(); ++i) {
    if (value[i] != '+' && value[i] != '-') {
      return usage(fmt::format("{} '{}' has something beside + and -", key, value));
    }
    signs[i] = value[i] == '+' ? 1 : -1;
  }
  return {};
}

Result<void> set_count_signs(WoodenOptions& options, std::string_view value) {
  if (value.size() != 3 && value.size() != 6) {
    return usage(fmt::format(
        "signs '{}' is not one + or - for each of the encoders A to C, or A to F", value));
  }
  options.count_signs = {1, 1, 1, 1, 1, 1};
  return read_signs(options.count_signs->data(), "signs", value);
}

Result<void> set_motor_signs(WoodenOptions& options, std::string_view value) {
  if (value.size() != 3) {
    return usage(
        fmt::format("motor_signs '{}' is not one + or - for each of the motors A to C", value));
  }
  options.motor_signs = {1, 1, 1};
  return read_signs(options.motor_signs->data(), "motor_signs", value);
}

Result<void> set_home(WoodenOptions& options, std::string_view value) {
  std::array<double, 3> home{};
  std::string_view rest = value;
  for (std::size_t i = 0; i < home.size(); ++i) {
    const std::size_t colon = rest.find(':');
    const bool last = i + 1 == home.size();
    const std::string_view item = rest.substr(0, colon);
    int count = 0;
    const char* end = item.data() + item.size();
    const auto parsed = std::from_chars(item.data(), end, count);
    if (parsed.ec != std::errc{} || parsed.ptr != end || std::abs(count) > max_counts ||
        (colon == std::string_view::npos) != last) {
      return usage(
          fmt::format("home '{}' is not three whole counts such as 0:0:6000, from -{} to {}", value,
                      max_counts, max_counts));
    }
    home[i] = count;
    if (!last) rest.remove_prefix(colon + 1);
  }
  options.home = home;
  return {};
}

Result<void> set_home_confirmed(WoodenOptions& options, std::string_view value) {
  for (const WoodenHome home : {WoodenHome::unconfirmed, WoodenHome::once, WoodenHome::always}) {
    if (value != to_string(home)) continue;
    options.home_confirmed = home;
    return {};
  }
  return usage(
      fmt::format("home_confirmed '{}' is not known; it can be no, once or always", value));
}

/// Amperes, with A or mA.
Result<void> set_current(double& target, std::string_view key, std::string_view value) {
  double number = 0;
  const char* end = value.data() + value.size();
  const auto parsed = std::from_chars(value.data(), end, number);
  const std::string_view unit(parsed.ptr, static_cast<std::size_t>(end - parsed.ptr));
  if (parsed.ec != std::errc{} || !std::isfinite(number) || (unit != "A" && unit != "mA")) {
    return usage(
        fmt::format("{} '{}' is not a current with its unit, such as 2A or 500mA", key, value));
  }
  const double current = unit == "A" ? number : number / 1000;
  if (!(current > 0 && current <= largest_current)) {
    return usage(fmt::format("{} {} is out of range; it must be above 0 and at most {} A", key,
                             value, largest_current));
  }
  target = current;
  return {};
}

Result<void> set_force_cap(WoodenOptions& options, std::string_view value) {
  const Result<double> cap = parse_quantity(value, Quantity::force);
  if (!cap) return usage("force_cap: " + cap.error().message);
  if (!(*cap > 0)) return usage(fmt::format("force_cap {} is not above 0", value));
  options.force_cap = *cap;
  return {};
}

/// A number of a motor's data sheet.
struct MotorNumber {
  std::string_view key, unit, example;
  double MotorData::*target;
  double most;
};

/// The largest numbers are far beyond any motor.
constexpr std::array<MotorNumber, 5> motor_numbers{{
    {"motor_resistance", "ohm", "2.5ohm", &MotorData::resistance, 1000},
    {"thermal_resistance", "K/W", "8K/W", &MotorData::thermal_resistance, 1000},
    {"thermal_time", "s", "16s", &MotorData::time_constant, 10000},
    {"winding_limit", "C", "125C", &MotorData::winding_limit, 300},
    {"ambient", "C", "25C", &MotorData::ambient, 100},
}};

Result<void> set_motor_number(WoodenOptions& options, const MotorNumber& wanted,
                              std::string_view value) {
  double number = 0;
  const char* end = value.data() + value.size();
  const auto parsed = std::from_chars(value.data(), end, number);
  const std::string_view unit(parsed.ptr, static_cast<std::size_t>(end - parsed.ptr));
  // Written so that NaN is out of range.
  if (parsed.ec != std::errc{} || unit != wanted.unit || !(number > 0 && number <= wanted.most)) {
    return usage(
        fmt::format("{} '{}' will not do; write it with its unit, such as {}, above 0 and "
                    "at most {}",
                    wanted.key, value, wanted.example, wanted.most));
  }
  options.motor.*wanted.target = number;
  return {};
}

Result<void> check_motor(const MotorData& motor) {
  const std::array<bool, 5> given{motor.resistance > 0, motor.thermal_resistance > 0,
                                  motor.time_constant > 0, motor.winding_limit > 0,
                                  !motor.source.empty()};
  const auto count = std::count(given.begin(), given.end(), true);
  if (count != 0 && count != static_cast<std::ptrdiff_t>(given.size())) {
    return usage(
        "motor_resistance, thermal_resistance, thermal_time, winding_limit and motor_source, which "
        "says where they stand, belong together; give all of them or none");
  }
  if (count != 0 && !(motor.winding_limit > motor.ambient)) {
    return usage(fmt::format("winding_limit {} C is not above ambient, {} C", motor.winding_limit,
                             motor.ambient));
  }
  return {};
}

Result<void> set(WoodenOptions& options, std::string_view key, std::string_view value) {
  if (key == "model") return set_model(options, value);
  if (key == "protocol") return set_protocol(options, value);
  if (key == "serial") return set_option_serial("woodenhaptics", options.serial, value);
  if (key == "signs") return set_count_signs(options, value);
  if (key == "motor_signs") return set_motor_signs(options, value);
  if (key == "keep_signs") {
    return set_option_switch("woodenhaptics", options.keep_signs, key, value);
  }
  if (key == "home") return set_home(options, value);
  if (key == "home_confirmed") return set_home_confirmed(options, value);
  if (key == "imax") return set_current(options.full_scale_current, key, value);
  if (key == "current_limit") return set_current(options.current_limit, key, value);
  if (key == "gravity") return set_option_switch("woodenhaptics", options.gravity, key, value);
  if (key == "force_cap") return set_force_cap(options, value);
  if (key == "motor_source") {
    options.motor.source = value;
    return {};
  }
  for (const MotorNumber& wanted : motor_numbers) {
    if (key == wanted.key) return set_motor_number(options, wanted, value);
  }
  return usage(fmt::format(
      "option '{}' is not known; the options are model, protocol, serial, signs, motor_signs, "
      "keep_signs, home, home_confirmed, imax, current_limit, gravity, force_cap, "
      "motor_resistance, "
      "thermal_resistance, thermal_time, winding_limit, ambient and motor_source",
      key));
}

}  // namespace

const char* to_string(WoodenHome home) noexcept {
  switch (home) {
    case WoodenHome::unconfirmed:
      return "no";
    case WoodenHome::once:
      return "once";
    case WoodenHome::always:
      return "always";
  }
  return "";
}

double wooden_force_cap(const WoodenModel& model) noexcept {
  return std::min(find_device_profile("wooden")->force_cap, model.max_force);
}

Result<WoodenOptions> parse_wooden_options(std::string_view text) {
  WoodenOptions options;
  options.full_scale_current = 0;
  const auto done = set_options(
      "woodenhaptics", text,
      [&](std::string_view key, std::string_view value) { return set(options, key, value); });
  if (!done) return tl::make_unexpected(done.error());
  if (const auto motor = check_motor(options.motor); !motor) {
    return tl::make_unexpected(motor.error());
  }
  if (options.keep_signs && !options.count_signs) {
    return usage("keep_signs=on keeps the signs that are named: name them too, such as signs=-+-");
  }
  if (!(options.full_scale_current > 0)) {
    options.full_scale_current = options.model->full_scale_current;
  }
  if (options.current_limit > options.full_scale_current) {
    return usage(fmt::format(
        "current_limit {} A is above imax, the {} A that the drives give at full scale; lower it, "
        "or give the imax of your drives",
        options.current_limit, options.full_scale_current));
  }
  const double cap = wooden_force_cap(*options.model);
  if (options.force_cap > cap) {
    return usage(fmt::format("force_cap {} is above what a {} may give, {}",
                             format_quantity(options.force_cap, Quantity::force),
                             options.model->name, format_quantity(cap, Quantity::force)));
  }
  if (!(options.force_cap > 0)) options.force_cap = cap;
  return options;
}

WoodenCalibration wooden_calibration(const WoodenOptions& options,
                                     WoodenProtocol protocol) noexcept {
  WoodenCalibration calibration;
  const double counting = protocol == WoodenProtocol::v1 ? -1 : 1;
  for (std::size_t i = 0; i < 3; ++i) {
    calibration.count_signs[i] = counting * options.model->direction[i];
  }
  if (options.count_signs) calibration.count_signs = *options.count_signs;
  for (std::size_t i = 0; i < 3; ++i) {
    calibration.motor_signs[i] = counting * calibration.count_signs[i];
  }
  if (options.motor_signs) calibration.motor_signs = *options.motor_signs;
  calibration.home = options.home ? *options.home : options.model->home;
  return calibration;
}

std::string signs_text(const double* signs, std::size_t count) {
  std::string text;
  for (std::size_t i = 0; i < count; ++i) text += signs[i] < 0 ? '-' : '+';
  return text;
}

}  // namespace spm::servo
