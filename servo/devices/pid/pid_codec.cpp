// SPDX-License-Identifier: Apache-2.0
#include "servo/devices/pid/pid_codec.hpp"

#include <algorithm>
#include <cmath>

namespace spm::servo {

namespace {

/// A message for the report that contains a field, all zeros.
PidMessage empty_message(const PidLayout& layout, const HidField& field) {
  PidMessage message{field.type, {}};
  message.bytes.resize(1 + layout.payload_bytes(field.type, field.report_id));
  message.bytes[0] = field.report_id;
  return message;
}

void set(PidMessage& message, const HidField& field, std::int64_t value) {
  set_hid_value(field, std::span(message.bytes).subspan(1), value);
}

void set(PidMessage& message, const PidChoice& choice) { set(message, choice.field, choice.value); }

/// A value that HID defines as no value: below the logical range, else all bits set [U].
std::int64_t null_value(const HidField& field) noexcept { return field.logical_min > 0 ? 0 : -1; }

/// Seconds for one count; a millisecond if the field has no unit of time.
double seconds_a_count(const HidField& field) noexcept {
  constexpr double millisecond = 1e-3;
  // The lowest digit of the unit is the system, the fourth the power of time; 1 is seconds.
  constexpr std::uint32_t all_but_system = 0xFFFFFFF0U, seconds = 0x1000;
  if ((field.unit & all_but_system) != seconds) return millisecond;
  const double unit = std::pow(10.0, field.unit_exponent);
  const auto logical = static_cast<double>(field.logical_max - field.logical_min);
  const auto physical = static_cast<double>(field.physical_max - field.physical_min);
  return logical > 0 && physical > 0 ? unit * physical / logical : unit;
}

/// A fraction of a circle; the whole logical range is one circle. Devices differ in whether the end
/// of the range is a full circle or one count less; the difference is less than a degree and a
/// half.
std::int64_t angle_value(const HidField& field, double turns) noexcept {
  const auto range = static_cast<double>(field.logical_max - field.logical_min);
  return field.logical_min + std::llround(turns * range);
}

/// The logical value that is nearest to 0.
std::int64_t zero_value(const HidField& field) noexcept {
  return std::max(field.logical_min, std::min<std::int64_t>(field.logical_max, 0));
}

void set_direction(const PidLayout& layout, std::size_t axis, PidMessage& message) {
  constexpr std::array<double, 2> turns{0.25, 0.5};  // east, south
  const auto& effect = layout.set_effect;
  switch (effect.direction_form) {
    case PidDirection::polar:
      // As the kernel's driver does: no axis is then enabled individually.
      if (effect.direction_enable) set(message, *effect.direction_enable, 1);
      set(message, *effect.direction[0], angle_value(*effect.direction[0], turns[axis]));
      return;
    case PidDirection::cartesian:
      for (std::size_t i = 0; i < layout.axes; ++i) {
        const HidField& part = *effect.direction[i];
        set(message, part, i == axis ? part.logical_max : zero_value(part));
      }
      break;
    case PidDirection::axes:
      break;
  }
  if (effect.axis_enable[axis]) set(message, *effect.axis_enable[axis], 1);
}

PidMessage operation(const PidLayout& layout, PidBlock block, const PidChoice& what) {
  PidMessage message = empty_message(layout, layout.operation.block);
  set(message, layout.operation.block, block);
  set(message, what);
  return message;
}

}  // namespace

std::int64_t hid_value(const HidField& field, std::span<const std::uint8_t> payload) noexcept {
  std::uint64_t bits = 0;
  for (unsigned i = 0; i < field.bits; ++i) {
    const std::size_t at = field.bit + i;
    bits |= (std::uint64_t{payload[at / 8]} >> at % 8 & 1U) << i;
  }
  if (field.bits == 0) return 0;
  const bool is_negative = field.logical_min < 0 && (bits >> (field.bits - 1U) & 1U) != 0;
  const auto value = static_cast<std::int64_t>(bits);
  return is_negative ? value - (std::int64_t{1} << field.bits) : value;
}

void set_hid_value(const HidField& field, std::span<std::uint8_t> payload,
                   std::int64_t value) noexcept {
  const auto bits = static_cast<std::uint64_t>(value);
  for (unsigned i = 0; i < field.bits; ++i) {
    const std::size_t at = field.bit + i;
    const auto mask = static_cast<std::uint8_t>(1U << at % 8);
    const bool is_set = (bits >> i & 1U) != 0;
    payload[at / 8] =
        static_cast<std::uint8_t>(is_set ? payload[at / 8] | mask : payload[at / 8] & ~mask);
  }
}

std::int64_t hid_time(const HidField& field, double seconds) noexcept {
  const double counts = std::round(seconds / seconds_a_count(field));
  const auto most = static_cast<double>(field.logical_max);
  return counts < most ? std::max(field.logical_min, static_cast<std::int64_t>(counts))
                       : field.logical_max;
}

bool take_pid_report(const PidLayout& layout, std::uint8_t id,
                     std::span<const std::uint8_t> payload, PidReport& report) noexcept {
  if (payload.size() < layout.payload_bytes(HidReportType::input, id)) return false;
  PidReport next = report;
  bool any = false;
  for (std::size_t axis = 0; axis < layout.axes; ++axis) {
    const HidField& field = layout.position[axis];
    if (field.report_id != id) continue;
    const std::int64_t value = hid_value(field, payload);
    if (value < field.logical_min || value > field.logical_max) return false;
    const auto range = static_cast<double>(field.logical_max - field.logical_min);
    const double place = 2 * static_cast<double>(value - field.logical_min) / range - 1;
    // In HID, Y grows towards the user.
    next.deflection[axis] = axis == 1 ? -place : place;
    any = true;
  }
  if (!any) return false;
  for (std::size_t i = 0; i < layout.buttons.size(); ++i) {
    const HidField& field = layout.buttons[i];
    if (field.report_id != id) continue;
    const std::uint32_t bit = std::uint32_t{1} << i;
    next.buttons = hid_value(field, payload) != 0 ? next.buttons | bit : next.buttons & ~bit;
  }
  report = next;
  return true;
}

PidMessage pid_control(const PidLayout& layout, const PidChoice& what) {
  PidMessage message = empty_message(layout, what.field);
  set(message, what);
  return message;
}

PidMessage pid_full_gain(const PidLayout& layout, const HidField& gain) {
  PidMessage message = empty_message(layout, gain);
  set(message, gain, gain.logical_max);
  return message;
}

PidMessage pid_create(const PidLayout& layout) {
  PidMessage message = empty_message(layout, layout.create.field);
  set(message, layout.create);
  return message;
}

PidMessage pid_load_request(const PidLayout& layout) {
  return empty_message(layout, layout.load.block);
}

std::optional<PidLoaded> decode_pid_load(const PidLayout& layout,
                                         std::span<const std::uint8_t> payload) {
  const auto& load = layout.load;
  if (payload.size() < layout.payload_bytes(load.block.type, load.block.report_id)) {
    return std::nullopt;
  }
  const auto says = [&payload](const PidChoice& choice) {
    return hid_value(choice.field, payload) == choice.value;
  };
  PidLoaded loaded{PidLoad::refused, hid_value(load.block, payload)};
  if (says(load.success)) {
    loaded.load = PidLoad::done;
  } else if (load.full && says(*load.full)) {
    loaded.load = PidLoad::full;
  }
  return loaded;
}

PidMessage pid_set_effect(const PidLayout& layout, PidBlock block, std::size_t axis,
                          PidDuration duration) {
  const auto& effect = layout.set_effect;
  PidMessage message = empty_message(layout, effect.block);
  set(message, effect.block, block);
  set(message, effect.constant);
  // All bits set means without end.
  set(message, effect.duration, duration ? hid_time(effect.duration, *duration) : -1);
  if (effect.gain) set(message, *effect.gain, effect.gain->logical_max);
  if (effect.trigger_button) {
    set(message, *effect.trigger_button, null_value(*effect.trigger_button));
  }
  set_direction(layout, axis, message);
  return message;
}

PidMessage pid_constant_force(const PidLayout& layout, PidBlock block, std::size_t axis,
                              double force) {
  const HidField& field = layout.constant_force.magnitude;
  PidMessage message = empty_message(layout, field);
  set(message, layout.constant_force.block, block);
  const auto most = static_cast<double>(std::min(field.logical_max, -field.logical_min));
  const double part = std::isfinite(force) ? std::clamp(force, -1.0, 1.0) : 0;
  // By convention it comes from the right, or from the user's side.
  const double magnitude = axis == 0 ? -part : part;
  set(message, field, std::llround(magnitude * most));
  return message;
}

PidMessage pid_start(const PidLayout& layout, PidBlock block) {
  PidMessage message = operation(layout, block, layout.operation.start);
  if (layout.operation.loops) set(message, *layout.operation.loops, 1);
  return message;
}

PidMessage pid_stop(const PidLayout& layout, PidBlock block) {
  return operation(layout, block, layout.operation.stop);
}

std::optional<PidMessage> pid_free(const PidLayout& layout, PidBlock block) {
  if (!layout.free_block) return std::nullopt;
  PidMessage message = empty_message(layout, *layout.free_block);
  set(message, *layout.free_block, block);
  return message;
}

PidCommand pid_command(const Vector3& force, double full_force, double cap,
                       const std::array<double, 2>& signs) noexcept {
  PidCommand command;
  if (!force.allFinite()) return command;
  const double size = std::hypot(force.x(), force.y());
  const double held = size > cap ? cap / size : 1;
  command.force = {signs[0] * held * force.x() / full_force,
                   signs[1] * held * force.y() / full_force};
  return command;
}

}  // namespace spm::servo
