// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <cstdint>
#include <functional>
#include <string>
#include <vector>

#include "formats/motion/recording.hpp"
#include "servo/record/tick_record.hpp"

namespace spm::servo {

/// Where a black box is written by default: in the user's folder for program state. Empty if there
/// is none.
[[nodiscard]] std::string default_black_box();

/// Keeps the last ticks. A moment after the force went off because of a fault, it writes them out
/// as a recording: what led to the fault and what came next. Several faults in a row share one
/// file; a later fault replaces the file. Belongs to the collecting thread.
class BlackBox {
 public:
  using Log = std::function<void(const std::string&)>;

  static constexpr double kept_seconds = 10;
  static constexpr double after_seconds = 0.5;

  /// `path`: where the file is written; empty: nowhere.
  BlackBox(std::string path, RecordingHeader header, Log warn);

  void take(const RecordingRow& row);

  /// At the end: writes the file if a fault still waits for it.
  void finish();

  /// How often the file was written.
  [[nodiscard]] std::uint64_t written() const noexcept { return written_; }
  [[nodiscard]] const std::string& path() const noexcept { return path_; }

 private:
  void write();

  std::string path_;
  RecordingHeader header_;
  Log warn_;
  std::vector<RecordingRow> rows_;  ///< a ring buffer
  std::size_t next_ = 0;
  bool is_full_ = false;
  std::vector<std::uint8_t> last_cause_;  ///< of each device
  bool pending_ = false;
  std::uint64_t due_tick_ = 0;
  std::uint64_t written_ = 0;
};

}  // namespace spm::servo
