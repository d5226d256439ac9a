// SPDX-License-Identifier: Apache-2.0
#include "servo/record/black_box.hpp"

#include <algorithm>
#include <cmath>
#include <cstdlib>
#include <filesystem>
#include <system_error>
#include <utility>

namespace spm::servo {

namespace {

/// Whether a cause is a fault, not part of a usual start or end.
bool is_fault(std::uint8_t cause) noexcept {
  switch (static_cast<ForceOff>(cause)) {
    case ForceOff::asset_lost:
    case ForceOff::not_a_number:
    case ForceOff::device_fault:
    case ForceOff::device_silent:
    case ForceOff::device_gone:
    case ForceOff::jumped:
      return true;
    case ForceOff::none:
    case ForceOff::starting:
    case ForceOff::stopping:
    case ForceOff::not_homed:
    case ForceOff::clutched:
    case ForceOff::outside_workspace:
    case ForceOff::application_silent:
      return false;
  }
  return true;
}

}  // namespace

std::string default_black_box() {
  const auto from = [](const char* name) -> std::filesystem::path {
    const char* value = std::getenv(name);
    return value == nullptr ? "" : value;
  };
  std::filesystem::path folder = from("XDG_STATE_HOME");
  if (folder.empty() && !from("HOME").empty()) folder = from("HOME") / ".local" / "state";
  if (!folder.is_absolute()) return {};
  return folder / "spm-servo" / "black-box.spmrec";
}

BlackBox::BlackBox(std::string path, RecordingHeader header, Log warn)
    : path_(std::move(path)),
      header_(std::move(header)),
      warn_(std::move(warn)),
      rows_(path_.empty() ? 0
                          : header_.devices.size() *
                                static_cast<std::size_t>(kept_seconds * header_.rate_hz)),
      last_cause_(header_.devices.size(), static_cast<std::uint8_t>(ForceOff::starting)) {}

void BlackBox::take(const RecordingRow& row) {
  if (rows_.empty()) return;
  if (pending_ && row.tick >= due_tick_) write();
  rows_[next_] = row;
  next_ = (next_ + 1) % rows_.size();
  is_full_ = is_full_ || next_ == 0;
  std::uint8_t& last = last_cause_[row.device];
  // A cause that did not end a force is nothing new, such as a device that is not there yet.
  const bool was_on = last == static_cast<std::uint8_t>(ForceOff::none);
  if (was_on && is_fault(row.cause) && !pending_) {
    pending_ = true;
    due_tick_ = row.tick + static_cast<std::uint64_t>(std::lround(after_seconds * header_.rate_hz));
  }
  last = row.cause;
}

void BlackBox::finish() {
  if (pending_) write();
}

void BlackBox::write() {
  pending_ = false;
  std::error_code ignored;
  std::filesystem::create_directories(std::filesystem::path(path_).parent_path(), ignored);
  auto file = RecordingWriter::create(path_, header_);
  if (!file) {
    warn_("the last ticks before a fault could not be kept: " + file.error().message);
    return;
  }
  if (is_full_) {
    for (std::size_t i = next_; i < rows_.size(); ++i) file->append(rows_[i]);
  }
  for (std::size_t i = 0; i < next_; ++i) file->append(rows_[i]);
  if (auto kept = file->commit(); !kept) {
    warn_("the last ticks before a fault could not be kept: " + kept.error().message);
    return;
  }
  ++written_;
  warn_("the ticks about the fault are kept in " + path_ + "; look at them with spm-servo replay");
}

}  // namespace spm::servo
