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

std::array<double, 4> to_numbers(const Eigen::Quaterniond& turn) noexcept {
  return {turn.w(), turn.x(), turn.y(), turn.z()};
}

std::uint16_t flags_of(const TickRecord& record) noexcept {
  const auto bit = [](bool on, RecordingFlag flag) {
    return on ? static_cast<unsigned>(flag) : 0U;
  };
  return static_cast<std::uint16_t>(
      bit(record.contact, recorded_contact) | bit(record.forgot, recorded_forgot) |
      bit(record.lost, recorded_lost) | bit(record.touched, recorded_touched) |
      bit(record.edited, recorded_edited) | bit(record.exchanged, recorded_exchanged) |
      bit(record.force_capped, recorded_force_capped) |
      bit(record.torque_capped, recorded_torque_capped) |
      bit(record.tool_capped, recorded_tool_capped) | bit(record.has_tool, recorded_tool) |
      bit(record.kept, recorded_kept));
}

}  // namespace

RecordingRow to_row(const TickRecord& record) noexcept {
  RecordingRow row;
  row.tick = record.tick;
  row.position = to_numbers(record.hand.position);
  row.orientation = to_numbers(record.hand.orientation);
  row.wanted = to_numbers(record.wanted.force);
  row.wanted_torque = to_numbers(record.wanted.torque);
  row.added = to_numbers(record.added.force);
  row.added_torque = to_numbers(record.added.torque);
  row.sent = to_numbers(record.sent.force);
  row.sent_torque = to_numbers(record.sent.torque);
  row.tool_position = to_numbers(record.tool.position);
  row.tool_orientation = to_numbers(record.tool.orientation);
  row.depth = record.depth;
  row.wake_ns = to_word(record.wake_ns);
  row.busy_ns = to_word(record.busy_ns);
  row.buttons = record.buttons;
  row.device = static_cast<std::uint16_t>(record.device);
  row.cause = static_cast<std::uint16_t>(record.cause);
  row.flags = flags_of(record);
  row.patches = record.patches;
  const ForceEffort& effort = record.effort;
  row.level = effort.level;
  row.refined = effort.refined;
  row.worked = effort.worked;
  row.culled = effort.culled;
  if (effort.held + effort.shortened > 0) {
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
