// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <optional>
#include <span>
#include <vector>

#include "common/base/vector.hpp"
#include "servo/devices/pid/pid_layout.hpp"

namespace spm::servo {

/// What a device has reported so far; each report changes a part of it. World frame: x to the
/// right, y in the direction in which the stick is pushed away from the user.
struct PidReport {
  /// -1 to 1 for each axis; 0 for one that the device does not have
  std::array<double, 2> deflection{};
  std::uint32_t buttons = 0;  ///< button 1 in the lowest bit
};

/// Forces on the hand along x and y, -1 to 1 as a fraction of the device's largest force; world
/// frame.
struct PidCommand {
  std::array<double, 2> force{};
};

/// A report to send. The id comes first if reports have one, else a 0, as hidraw expects it.
struct PidMessage {
  HidReportType type = HidReportType::output;
  std::vector<std::uint8_t> bytes;
};

/// A block of the device's memory that holds an effect.
using PidBlock = std::int64_t;

/// The device's answer after it was told to create an effect.
enum class PidLoad : std::uint8_t {
  done,
  full,     ///< there is no room for another effect
  refused,  ///< neither; for example the device is still busy
};

struct PidLoaded {
  PidLoad load = PidLoad::refused;
  PidBlock block = 0;
};

/// How long an effect plays unless it is started again, s. If the device respects it, this is its
/// watchdog. Empty: it plays until it is stopped.
using PidDuration = std::optional<double>;

/// The value of a field, with its sign. `payload` is a report without its id, and long enough.
[[nodiscard]] std::int64_t hid_value(const HidField& field,
                                     std::span<const std::uint8_t> payload) noexcept;
/// Sets a field without changing others in the same bytes. Bits that do not fit are dropped.
void set_hid_value(const HidField& field, std::span<std::uint8_t> payload,
                   std::int64_t value) noexcept;
/// Converts seconds to counts of a time field: by its unit, or as milliseconds if it has none [U].
/// Limited to the field's logical maximum.
[[nodiscard]] std::int64_t hid_time(const HidField& field, double seconds) noexcept;

/// Takes an input report without its id. False, without a change, if it has neither axis, is
/// shorter than its descriptor says, or if an axis is outside its range, which is how HID marks a
/// missing value.
[[nodiscard]] bool take_pid_report(const PidLayout& layout, std::uint8_t id,
                                   std::span<const std::uint8_t> payload,
                                   PidReport& report) noexcept;

/// A message for one of the device's named commands, such as reset or enable actuators.
[[nodiscard]] PidMessage pid_control(const PidLayout& layout, const PidChoice& what);
/// Sets a gain to its maximum. The gain of the whole device is not always at the maximum at first.
[[nodiscard]] PidMessage pid_full_gain(const PidLayout& layout, const HidField& gain);
/// Creates an effect of constant force. An empty Block Load report asks for the result.
[[nodiscard]] PidMessage pid_create(const PidLayout& layout);
[[nodiscard]] PidMessage pid_load_request(const PidLayout& layout);
/// Nothing if the answer is too short. `payload` is without its id.
[[nodiscard]] std::optional<PidLoaded> decode_pid_load(const PidLayout& layout,
                                                       std::span<const std::uint8_t> payload);

/// Sets along which axis (0: x, 1: y) an effect acts, and for how long, at the effect's full gain.
/// Its direction is 90 or 180 degrees from the north, clockwise, or that axis alone. By convention
/// a force comes from its direction, so that a positive magnitude pushes to the left, or away from
/// the user. Firmware disagrees about that [U]; PidOptions has signs.
[[nodiscard]] PidMessage pid_set_effect(const PidLayout& layout, PidBlock block, std::size_t axis,
                                        PidDuration duration);
/// The force of an axis's effect, -1 to 1 along that axis of the world, limited to that range. NaN
/// gives none.
[[nodiscard]] PidMessage pid_constant_force(const PidLayout& layout, PidBlock block,
                                            std::size_t axis, double force);
[[nodiscard]] PidMessage pid_start(const PidLayout& layout, PidBlock block);
[[nodiscard]] PidMessage pid_stop(const PidLayout& layout, PidBlock block);
/// Nothing if the descriptor has no such report.
[[nodiscard]] std::optional<PidMessage> pid_free(const PidLayout& layout, PidBlock block);

/// Converts a force of the world, N, to fractions of `full_force` (N, above 0). Its x and y are
/// limited to `cap`, with the direction kept; a force that is not finite gives none. `signs`: +1 or
/// -1 for devices that push the other way.
[[nodiscard]] PidCommand pid_command(const Vector3& force, double full_force, double cap,
                                     const std::array<double, 2>& signs) noexcept;

}  // namespace spm::servo
