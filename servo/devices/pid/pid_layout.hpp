// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <optional>
#include <string>
#include <string_view>
#include <tl/expected.hpp>
#include <vector>

#include "servo/devices/hid/hid_descriptor.hpp"

namespace spm::servo {

/// How the axis along which an effect acts is given. Each axis has an effect of its own, so that
/// its direction is sent only once.
enum class PidDirection : std::uint8_t {
  polar,      ///< an angle from the north, clockwise, as the kernel's driver sends it
  cartesian,  ///< a component for each axis
  axes,       ///< the axis is enabled, and no direction is sent
};

[[nodiscard]] const char* to_string(PidDirection direction) noexcept;
[[nodiscard]] std::optional<PidDirection> find_pid_direction(std::string_view name) noexcept;

/// A named command of a device: a value of an array, or a bit of its own.
struct PidChoice {
  HidField field;
  std::int64_t value = 0;
};

/// Where the reports of a device of the PID class have the fields that constant force needs.
struct PidLayout {
  /// Number of axes that have a position and take force: 1 (X, as a wheel), or 2 (X, Y). Z is a
  /// throttle on most sticks, and no axis of a hand.
  std::size_t axes = 1;
  std::array<HidField, 2> position;
  std::vector<HidField> buttons;  ///< button 1 first; 32 at most

  struct {
    HidField block, duration;
    PidChoice constant;
    std::optional<HidField> gain, trigger_button, direction_enable;
    std::array<std::optional<HidField>, 2> axis_enable, direction;
    PidDirection direction_form = PidDirection::axes;
  } set_effect;
  struct {
    HidField block, magnitude;
  } constant_force;
  struct {
    HidField block;
    PidChoice start, stop;
    std::optional<HidField> loops;
  } operation;
  PidChoice create;  ///< a feature report
  struct {
    HidField block;
    PidChoice success;
    std::optional<PidChoice> full;
  } load;                                    ///< a feature report
  std::optional<HidField> free_block, gain;  ///< gain: of the whole device
  /// of the device, of all that it plays, and of its actuators
  std::optional<PidChoice> reset, stop_all, enable;
  /// a feature report: whether the device manages the memory of effects
  std::optional<HidField> device_managed_pool;

  bool has_ids = false;
  std::vector<HidReport> reports;

  /// Size of a report in bytes, without its id; 0 if there is no such report.
  [[nodiscard]] std::size_t payload_bytes(HidReportType type, std::uint8_t id) const noexcept;
};

/// Finds the fields that constant force needs. `wanted` says how directions are to be given.
/// Without it: polar if the descriptor has angles, cartesian if it has a component for each axis,
/// else axes. Errors: a sentence that says what the descriptor lacks, with its usage. Usages are
/// those of USB PID 1.0; how devices interpret a direction is unverified [U].
[[nodiscard]] tl::expected<PidLayout, std::string> find_pid_layout(
    const HidDescriptor& descriptor, std::optional<PidDirection> wanted = {});

}  // namespace spm::servo
