// SPDX-License-Identifier: Apache-2.0
#include "servo/record/black_box.hpp"

#include <algorithm>
#include <cmath>
#include <utility>

namespace spm::servo {

namespace {

/// Whether a cause is a fault, not part of a usual start or end.
bool is_fault(std::uint16_t cause) noexcept {
  switch (static_cast<ForceOff>(cause)) {
    case ForceOff::asset_lost:
    case ForceOff::not_a_number:
    case ForceOff::device_fault:
    case ForceOff::device_silent:
    case ForceOff::device_gone:
    case ForceOff::jumped:
    case ForceOff::stalled:
    case ForceOff::runaway:
      return true;
    case ForceOff::none:
    case ForceOff::starting:
    case ForceOff::stopping:
    case ForceOff::not_homed:
    case ForceOff::clutched:
    case ForceOff::outside_workspace:
    case ForceOff::application_silent:
    case ForceOff::unacknowledged:
    case ForceOff::not_enabled:
    case ForceOff::unconfirmed:
      return false;
  }
  return true;
}

}  // namespace

BlackBox::BlackBox(std::string pattern, BlackBoxMemory& memory, Log warn)
    : pattern_(std::move(pattern)), memory_(memory), warn_(std::move(warn)) {}

void BlackBox::begin(const RecordingHeader& header) {
  rate_hz_ = header.rate_hz;
  last_cause_.resize(header.devices.size(), static_cast<std::uint8_t>(ForceOff::starting));
  begun_ = first_row_ = true;
  if (memory_.begin(recording_start(header)) || given_up_) return;
  given_up_ = true;
  warn_("the scene is too large for the black box, which keeps no more ticks; use --record");
}

void BlackBox::take(std::string_view part, const HeaderNow& header) {
  if (given_up_) return;
  if (!begun_) begin(header());
  if (memory_.append(part)) return;
  begin(header());
  static_cast<void>(memory_.append(part));
}

void BlackBox::take(const RecordingRow& row, std::string_view part, const HeaderNow& header) {
  if (given_up_) return;
  if (pending_ && row.tick >= due_tick_) write();
  // A half begins with a whole tick.
  const bool due = !begun_ || (!first_row_ && row.device == 0 && row.tick >= turn_tick_);
  if (due) begin(header());
  if (!memory_.append(part)) {
    begin(header());
    if (!memory_.append(part)) return;
  }
  if (std::exchange(first_row_, false)) {
    turn_tick_ = row.tick + static_cast<std::uint64_t>(std::llround(kept_seconds * rate_hz_));
  }
  note(row);
}

/// Whether a fault ended the force.
void BlackBox::note(const RecordingRow& row) {
  if (row.device >= last_cause_.size()) return;
  std::uint16_t& last = last_cause_[row.device];
  // A cause that did not end a force is nothing new, such as a device that is not there yet.
  const bool was_on = last == static_cast<std::uint16_t>(ForceOff::none);
  if (was_on && is_fault(row.cause) && !pending_ && row.tick >= next_tick_) {
    pending_ = true;
    next_tick_ = row.tick + static_cast<std::uint64_t>(std::lround(pause_seconds * rate_hz_));
    due_tick_ = row.tick + static_cast<std::uint64_t>(std::lround(after_seconds * rate_hz_));
  }
  last = row.cause;
}

void BlackBox::finish() {
  if (pending_) write();
}

void BlackBox::write() {
  pending_ = false;
  const auto kept = write_black_box(memory_, pattern_);
  if (!kept) {
    warn_("the last ticks before a fault could not be kept: " + kept.error().message);
    return;
  }
  ++written_;
  warn_("the ticks about the fault are kept in " + *kept +
        "; look at them with spm-servo view --recording");
}

}  // namespace spm::servo
