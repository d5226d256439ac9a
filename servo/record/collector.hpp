// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <functional>
#include <optional>
#include <string>
#include <vector>

#include "servo/base/statistics.hpp"
#include "servo/record/run_recorder.hpp"
#include "servo/record/tick_record.hpp"
#include "servo/record/trace_csv.hpp"

namespace spm::servo {

/// The other end of the ring: turns the loop's records into statistics, log messages and, if asked
/// for, a trace, a recording and a black box. A device whose force comes and goes is told of
/// `most_lines` times, and then once in `line_seconds`, with how often it changed meanwhile.
/// Belongs to one thread, which may allocate, log and block.
class Collector {
 public:
  using Log = std::function<void(const std::string&)>;

  static constexpr double most_lines = 20, line_seconds = 10;

  /// What is kept of a run beside its statistics.
  struct Keeps {
    std::optional<TraceCsv> trace;        ///< of the first device
    std::optional<RunRecorder> recorder;  ///< of all devices
  };

  Collector(TickRing& ring, std::size_t devices, double rate_hz, Keeps keeps, Log warn);

  /// Takes all records that are in the ring now.
  void drain();

  /// After the last drain: completes the trace and the recording. Errors: file_or_device.
  [[nodiscard]] Result<void> finish();

  /// How often the black box was written.
  [[nodiscard]] std::uint64_t black_boxes() const {
    return keeps_.recorder ? keeps_.recorder->black_boxes() : 0;
  }
  [[nodiscard]] Summary wake_us() const { return wake_.summary_us(); }
  [[nodiscard]] Summary busy_us() const { return busy_.summary_us(); }

 private:
  /// What is told of one device.
  struct Told {
    ForceOff cause = ForceOff::none;
    double lines = most_lines;  ///< that may still be told
    std::uint64_t tick = 0;     ///< up to which lines were counted
    std::uint64_t untold = 0;   ///< changes
  };

  void take(const TickRecord& record);
  void tell(const TickRecord& record, const std::string& what);

  TickRing& ring_;
  double rate_hz_;
  Keeps keeps_;
  Log warn_;
  DurationHistogram wake_, busy_;
  std::vector<Told> told_;  ///< of each device
};

}  // namespace spm::servo
