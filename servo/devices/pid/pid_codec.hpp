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

/// What a device told of itself so far; a report changes a part of it. World frame: x to the right,
/// and y where the stick is pushed away from the user.
struct PidReport {
  std::array<double, 2> deflection{};  ///< -1 to 1 an axis; 0 of one that it has not
  std::uint32_t buttons = 0;           ///< button 1 in the lowest bit
};

/// Forces on the hand along x and y, -1 to 1 of the device's greatest; world frame.
struct PidCommand {
  std::array<double, 2> force{};
};

/// A report to send, the id first where reports have one, else a 0, as hidraw takes it.
struct PidMessage {
  HidReportType type = HidReportType::output;
  std::vector<std::uint8_t> bytes;
};

/// A block of the device's memory that holds an effect.
using PidBlock = std::int64_t;

/// What the device says of an effect that it was told to create.
enum class PidLoad : std::uint8_t {
  done,
  full,     ///< it has no room for another
  refused,  ///< neither, as while it is still at it
};

struct PidLoaded {
  PidLoad load = PidLoad::refused;
  PidBlock block = 0;
};

/// How long an effect plays unless it is started again, s; where the device minds it, this is its
/// watchdog. Nothing: it plays until it is stopped.
using PidDuration = std::optional<double>;

/// The value of a field, with its sign. `payload` is a report without its id, and long enough.
[[nodiscard]] std::int64_t hid_value(const HidField& field,
                                     std::span<const std::uint8_t> payload) noexcept;
/// Sets a field, whatever the others in the same bytes are; bits that it has not are dropped.
void set_hid_value(const HidField& field, std::span<std::uint8_t> payload,
                   std::int64_t value) noexcept;
/// Counts of a field of time for seconds: by its unit, or as milliseconds where it has none [U]. No
/// more than its logical maximum.
[[nodiscard]] std::int64_t hid_time(const HidField& field, double seconds) noexcept;

/// Takes an input report without its id. False, and nothing changed, where it has neither axis, is
/// shorter than its descriptor says, or where an axis is outside of its range, which is how HID
/// says that it has no value.
[[nodiscard]] bool take_pid_report(const PidLayout& layout, std::uint8_t id,
                                   std::span<const std::uint8_t> payload,
                                   PidReport& report) noexcept;

/// Tells the device something that it knows by name: to reset itself, to switch its motors on.
[[nodiscard]] PidMessage pid_control(const PidLayout& layout, const PidChoice& what);
/// Sets a gain to its greatest, which that of the whole device is not always at first.
[[nodiscard]] PidMessage pid_full_gain(const PidLayout& layout, const HidField& gain);
/// Makes room for an effect of constant force. What became of it is asked with an empty Block Load
/// report.
[[nodiscard]] PidMessage pid_create(const PidLayout& layout);
[[nodiscard]] PidMessage pid_load_request(const PidLayout& layout);
/// Nothing where the answer is too short. `payload` is without its id.
[[nodiscard]] std::optional<PidLoaded> decode_pid_load(const PidLayout& layout,
                                                       std::span<const std::uint8_t> payload);

/// Tells along which axis (0: x, 1: y) an effect acts, for how long, at the effect's full gain. Its
/// direction is 90 or 180 degrees from the north, clockwise, or that axis's alone: by convention a
/// force comes from there, so that a positive magnitude pushes to the left, or away from the user.
/// Firmware disagrees about that [U]; PidOptions has signs.
[[nodiscard]] PidMessage pid_set_effect(const PidLayout& layout, PidBlock block, std::size_t axis,
                                        PidDuration duration);
/// The force of an axis's effect, -1 to 1 along that axis of the world; held to that. One that is
/// not a number is none.
[[nodiscard]] PidMessage pid_constant_force(const PidLayout& layout, PidBlock block,
                                            std::size_t axis, double force);
[[nodiscard]] PidMessage pid_start(const PidLayout& layout, PidBlock block);
[[nodiscard]] PidMessage pid_stop(const PidLayout& layout, PidBlock block);
/// Nothing where the descriptor has no such report.
[[nodiscard]] std::optional<PidMessage> pid_free(const PidLayout& layout, PidBlock block);

/// Parts of `full_force` (N, above 0) for a force of the world, N. What it has in x and y is held
/// to `cap`, its direction kept; a force that is not finite is none. `signs`: +1 or -1 for devices
/// that push the other way.
[[nodiscard]] PidCommand pid_command(const Vector3& force, double full_force, double cap,
                                     const std::array<double, 2>& signs) noexcept;

}  // namespace spm::servo
