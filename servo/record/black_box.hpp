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

/// Where a black box is written unless something else is asked for: in the user's folder of states;
/// empty where there is none.
[[nodiscard]] std::string default_black_box();

/// Keeps the last ticks, and writes them out as a recording a moment after the force went off for a
/// fault: what led to it, and what came next. Of several faults in a row one file tells; a later
/// one replaces it. Belongs to the collecting thread.
class BlackBox {
 public:
  using Log = std::function<void(const std::string&)>;

  static constexpr double kept_seconds = 10;
  static constexpr double after_seconds = 0.5;

  /// `path`: where it is written; empty: nowhere.
  BlackBox(std::string path, RecordingHeader header, Log warn);

  void take(const RecordingRow& row);

  /// Writes what a fault still waits for, at the end.
  void finish();

  /// How often a file was written.
  [[nodiscard]] std::uint64_t written() const noexcept { return written_; }
  [[nodiscard]] const std::string& path() const noexcept { return path_; }

 private:
  void write();

  std::string path_;
  RecordingHeader header_;
  Log warn_;
  std::vector<RecordingRow> rows_;  ///< in a ring
  std::size_t next_ = 0;
  bool is_full_ = false;
  std::vector<std::uint8_t> last_cause_;  ///< of each device
  bool pending_ = false;
  std::uint64_t due_tick_ = 0;
  std::uint64_t written_ = 0;
};

}  // namespace spm::servo
