// SPDX-License-Identifier: Apache-2.0
#include "servo/record/tick_record.hpp"

#include <algorithm>
#include <limits>

namespace spm::servo {

namespace {

std::int32_t to_word(std::int64_t ns) noexcept {
  constexpr std::int64_t most = std::numeric_limits<std::int32_t>::max();
  return static_cast<std::int32_t>(std::clamp(ns, -most, most));
}

std::array<double, 3> to_numbers(const Vector3& vector) noexcept {
  return {vector.x(), vector.y(), vector.z()};
}

}  // namespace

RecordingRow to_row(const TickRecord& record) noexcept {
  RecordingRow row;
  row.tick = record.tick;
  row.position = to_numbers(record.position);
  row.wanted = to_numbers(record.wanted);
  row.added = to_numbers(record.added);
  row.sent = to_numbers(record.force);
  row.depth = record.depth;
  row.wake_ns = to_word(record.wake_ns);
  row.busy_ns = to_word(record.busy_ns);
  row.buttons = record.buttons;
  row.device = static_cast<std::uint16_t>(record.device);
  row.cause = static_cast<std::uint8_t>(record.cause);
  row.flags = static_cast<std::uint8_t>(
      (record.contact ? recorded_contact : 0) | (record.forgot ? recorded_forgot : 0) |
      (record.lost ? recorded_lost : 0) | (record.touched ? recorded_touched : 0) |
      (record.edited ? recorded_edited : 0) | (record.exchanged ? recorded_exchanged : 0));
  const ForceEffort& effort = record.effort;
  if (effort.degraded()) {
    row.first = static_cast<std::uint16_t>(effort.first);
    row.exact = static_cast<std::uint16_t>(effort.exact);
    row.held = static_cast<std::uint16_t>(effort.held);
    row.shortened = static_cast<std::uint16_t>(effort.shortened);
  }
  return row;
}

TickRing make_tick_ring(double rate_hz, std::size_t devices) {
  const auto capacity = static_cast<std::size_t>(ring_seconds * rate_hz) * devices;
  TickRing ring(capacity);
  TickRecord record;
  while (ring.try_enqueue(record)) {
  }
  while (ring.try_dequeue(record)) {
  }
  return ring;
}

}  // namespace spm::servo
