// SPDX-License-Identifier: Apache-2.0
#include "servo/devices/base/device_placement.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <charconv>
#include <vector>

#include "common/base/device_profile.hpp"
#include "common/base/units.hpp"
#include "servo/devices/base/option_list.hpp"

namespace spm::servo {

namespace {

constexpr std::array<std::string_view, 4> keys{"axes", "clutch_button", "stiffness_cap",
                                               "workspace"};

/// The number of buttons in a DeviceState.
constexpr std::uint32_t max_buttons = 32;

/// N/m; the largest stiffness of any profile.
constexpr double stiffest = std::max_element(device_profiles.begin(), device_profiles.end(),
                                             [](const DeviceProfile& a, const DeviceProfile& b) {
                                               return a.stiffness_cap < b.stiffness_cap;
                                             })
                                ->stiffness_cap;

constexpr double longest_edge = 10;  // m

constexpr std::string_view axis_names = "xyz";

Result<void> set_axes(const std::string& device, DevicePlacement& placement,
                      std::string_view value) {
  const auto axes = DeviceAxes::parse(value);
  if (!axes) {
    return option_error(
        device, fmt::format("axes '{}' does not name the device's axis that becomes x, y and z, "
                            "each with its sign and once; write axes=+x+y+z, or axes=-x+z+y",
                            value));
  }
  placement.axes = *axes;
  return {};
}

Result<void> set_clutch_button(const std::string& device, DevicePlacement& placement,
                               std::string_view value) {
  const char* const end = value.data() + value.size();
  std::uint32_t button = 0;
  const auto parsed = std::from_chars(value.data(), end, button);
  if (parsed.ec != std::errc{} || parsed.ptr != end || button < 1 || button > max_buttons) {
    return option_error(device, fmt::format("clutch_button '{}' is no button; it must be a whole "
                                            "number from 1 to {}",
                                            value, max_buttons));
  }
  placement.clutch_button = button;
  return {};
}

Result<void> set_workspace(const std::string& device, DevicePlacement& placement,
                           std::string_view value) {
  Vector3 edges = Vector3::Zero();
  if (value != "off") {
    if (std::count(value.begin(), value.end(), 'x') != 2) {
      return option_error(device, fmt::format("workspace '{}' is not three edges; write "
                                              "workspace=100mmx80mmx60mm, or workspace=off",
                                              value));
    }
    std::string_view rest = value;
    for (double& edge : edges) {
      const std::size_t end = rest.find('x');
      Result<void> done = set_option_quantity(device, edge, "workspace", rest.substr(0, end),
                                              Quantity::length, longest_edge);
      if (!done) return done;
      rest = end == std::string_view::npos ? std::string_view() : rest.substr(end + 1);
    }
  }
  placement.workspace = edges / 2;
  return {};
}

Result<void> set(const std::string& device, DevicePlacement& placement,
                 const DeviceOption& option) {
  if (option.key == "axes") return set_axes(device, placement, option.value);
  if (option.key == "clutch_button") return set_clutch_button(device, placement, option.value);
  if (option.key == "workspace") return set_workspace(device, placement, option.value);
  double cap = 0;
  Result<void> done =
      set_option_quantity(device, cap, option.key, option.value, Quantity::stiffness, stiffest);
  if (done) placement.stiffness_cap = cap;
  return done;
}

}  // namespace

std::optional<DeviceAxes> DeviceAxes::parse(std::string_view text) {
  if (text.size() != 6) return std::nullopt;
  DeviceAxes axes;
  std::array<bool, 3> named{};
  for (std::size_t i = 0; i < 3; ++i) {
    const char sign = text[2 * i];
    const std::size_t axis = axis_names.find(text[2 * i + 1]);
    if ((sign != '+' && sign != '-') || axis == std::string_view::npos || named[axis]) {
      return std::nullopt;
    }
    named[axis] = true;
    axes.axes_[i] = static_cast<int>(axis);
    axes.signs_[i] = sign == '-' ? -1 : 1;
  }
  return axes;
}

std::string DeviceAxes::text() const {
  std::string text;
  for (std::size_t i = 0; i < 3; ++i) {
    text += signs_[i] < 0 ? '-' : '+';
    text += axis_names[static_cast<std::size_t>(axes_[i])];
  }
  return text;
}

bool DeviceAxes::mirrored() const noexcept {
  // A cyclic permutation of the axes is even; an exchange of two axes is odd.
  const int permutation = (axes_[1] - axes_[0] + 3) % 3 == 1 ? 1 : -1;
  return permutation * signs_[0] * signs_[1] * signs_[2] < 0;
}

Vector3 DeviceAxes::to_world(const Vector3& vector) const noexcept {
  Vector3 world;
  for (std::size_t i = 0; i < 3; ++i) {
    world[static_cast<Eigen::Index>(i)] = signs_[i] * vector[axes_[i]];
  }
  return world;
}

Vector3 DeviceAxes::from_world(const Vector3& vector) const noexcept {
  Vector3 device;
  for (std::size_t i = 0; i < 3; ++i) {
    device[axes_[i]] = signs_[i] * vector[static_cast<Eigen::Index>(i)];
  }
  return device;
}

Vector3 DeviceAxes::turn_to_world(const Vector3& vector) const noexcept {
  return (mirrored() ? -1.0 : 1.0) * to_world(vector);
}

Vector3 DeviceAxes::turn_from_world(const Vector3& vector) const noexcept {
  return (mirrored() ? -1.0 : 1.0) * from_world(vector);
}

Eigen::Quaterniond DeviceAxes::to_world(const Eigen::Quaterniond& orientation) const noexcept {
  Eigen::Quaterniond world = orientation;
  world.vec() = turn_to_world(orientation.vec());
  return world;
}

Eigen::Quaterniond DeviceAxes::from_world(const Eigen::Quaterniond& orientation) const noexcept {
  Eigen::Quaterniond device = orientation;
  device.vec() = turn_from_world(orientation.vec());
  return device;
}

Result<PlacedOptions> take_placement(const std::string& device, std::string_view options) {
  PlacedOptions placed;
  const auto list = split_options(device, options);
  // If a driver of that name exists, it reports what is wrong.
  if (!list) return PlacedOptions{{}, std::string(options)};
  std::vector<std::string_view> taken;
  for (const DeviceOption& option : *list) {
    if (std::find(keys.begin(), keys.end(), option.key) == keys.end()) {
      if (!placed.own.empty()) placed.own += ',';
      placed.own.append(option.key).append("=").append(option.value);
      continue;
    }
    if (std::find(taken.begin(), taken.end(), option.key) != taken.end()) {
      return option_error(device, fmt::format("{} is given twice; leave one away", option.key));
    }
    taken.push_back(option.key);
    const Result<void> done = set(device, placed.placement, option);
    if (!done) return tl::make_unexpected(done.error());
  }
  return placed;
}

}  // namespace spm::servo
