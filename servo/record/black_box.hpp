// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <cstdint>
#include <functional>
#include <string>
#include <string_view>
#include <vector>

#include "formats/motion/recording.hpp"
#include "servo/record/black_box_files.hpp"
#include "servo/record/black_box_memory.hpp"
#include "servo/record/tick_record.hpp"

namespace spm::servo {

/// Keeps the last ten to twenty seconds of ticks in a memory that another process may share. A
/// moment after the force went off because of a fault, it writes them out as a recording: what led
/// to the fault and what came next. Several faults in a row share one file, and none is written
/// within `pause_seconds` of the last. Belongs to the collecting thread.
class BlackBox {
 public:
  using Log = std::function<void(const std::string&)>;
  /// The header of a recording that begins now: with the scene as it is.
  using HeaderNow = std::function<RecordingHeader()>;

  static constexpr double kept_seconds = 10;  ///< at least, unless a great many objects move
  static constexpr double after_seconds = 0.5;
  static constexpr double pause_seconds = 60;

  /// `pattern`: where files are written (write_black_box). `memory` must outlive this.
  BlackBox(std::string pattern, BlackBoxMemory& memory, Log warn);

  /// A part of a recording (append_part), which is no row.
  void take(std::string_view part, const HeaderNow& header);
  /// A row, and the same row as a part.
  void take(const RecordingRow& row, std::string_view part, const HeaderNow& header);

  /// At the end: writes the file if a fault still waits for it.
  void finish();

  /// How many files were written.
  [[nodiscard]] std::uint64_t written() const noexcept { return written_; }

 private:
  void begin(const RecordingHeader& header);
  void note(const RecordingRow& row);
  void write();

  std::string pattern_;
  BlackBoxMemory& memory_;
  Log warn_;
  double rate_hz_ = 1000;
  bool begun_ = false;
  bool given_up_ = false;
  bool first_row_ = true;                  ///< of the half
  std::uint64_t turn_tick_ = 0;            ///< in which the next half begins
  std::vector<std::uint16_t> last_cause_;  ///< of each device
  bool pending_ = false;
  std::uint64_t due_tick_ = 0;
  std::uint64_t next_tick_ = 0;  ///< before which no other fault is kept
  std::uint64_t written_ = 0;
};

}  // namespace spm::servo
