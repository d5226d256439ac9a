// SPDX-License-Identifier: Apache-2.0
#include "servo/playback/playback_marks.hpp"

#include <algorithm>
#include <optional>

#include "servo/safety/safety.hpp"

namespace spm::servo {

namespace {

/// Whether a row belongs to a mark of a kind.
bool shows(const RecordingRow& row, MarkKind kind, std::int64_t period_ns) noexcept {
  switch (kind) {
    case MarkKind::off:
      return row.cause != 0;
    case MarkKind::lost:
      return (row.flags & recorded_lost) != 0;
    case MarkKind::late:
      return std::int64_t(row.wake_ns) + row.busy_ns > period_ns;
    case MarkKind::capped:
      return (row.flags & (recorded_force_capped | recorded_torque_capped)) != 0;
    case MarkKind::edited:
      return (row.flags & recorded_edited) != 0;
    case MarkKind::exchanged:
      return (row.flags & recorded_exchanged) != 0;
  }
  return false;
}

}  // namespace

const char* to_string(MarkKind kind) noexcept {
  constexpr std::array<const char*, mark_kinds> names{"off",    "lost",   "late",
                                                      "capped", "edited", "exchanged"};
  return names[static_cast<std::size_t>(kind)];
}

Marks marks_of(const Recording& recording, std::size_t device, std::size_t most) {
  const double rate = recording.header.rate_hz;
  const auto period_ns = static_cast<std::int64_t>(1e9 / rate);
  const auto gap = static_cast<std::uint64_t>(mark_gap_seconds * rate);
  Marks marks;
  std::array<std::optional<Mark>, mark_kinds> open;
  const auto close = [&](std::size_t kind) {
    if (!open[kind]) return;
    if (marks.found[kind]++ < most) marks.list.push_back(*open[kind]);
    open[kind].reset();
  };
  for (const RecordingRow& row : recording.rows) {
    if (row.device != device) continue;
    for (std::size_t i = 0; i < mark_kinds; ++i) {
      const auto kind = static_cast<MarkKind>(i);
      if (!shows(row, kind, period_ns)) continue;
      const std::uint16_t cause = kind == MarkKind::off ? row.cause : std::uint16_t{0};
      if (open[i] && (row.tick > open[i]->last + gap || open[i]->cause != cause)) close(i);
      if (!open[i]) open[i] = Mark{kind, row.tick, row.tick, cause};
      open[i]->last = row.tick;
    }
  }
  for (std::size_t i = 0; i < mark_kinds; ++i) close(i);
  std::stable_sort(marks.list.begin(), marks.list.end(), [](const Mark& one, const Mark& other) {
    return one.first != other.first ? one.first < other.first : one.kind < other.kind;
  });
  return marks;
}

std::string cure_of_cause(const std::string& name) {
  for (std::size_t i = 0; i < force_off_count; ++i) {
    const auto cause = static_cast<ForceOff>(i);
    if (name == to_string(cause)) return cure_of(cause);
  }
  return "";
}

}  // namespace spm::servo
