// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <functional>
#include <optional>
#include <string>
#include <vector>

#include "formats/motion/recording.hpp"
#include "servo/base/statistics.hpp"
#include "servo/record/black_box.hpp"
#include "servo/record/tick_record.hpp"
#include "servo/record/trace_csv.hpp"

namespace spm::servo {

/// The other end of the ring: turns the loop's records into statistics, log messages and, if asked
/// for, a trace, a recording and a black box. Belongs to one thread, which may allocate, log and
/// block.
class Collector {
 public:
  using Log = std::function<void(const std::string&)>;

  /// What is kept of a run beside its statistics.
  struct Keeps {
    std::optional<TraceCsv> trace;             ///< of the first device
    std::optional<RecordingWriter> recording;  ///< of all devices
    std::optional<BlackBox> black_box;
  };

  Collector(TickRing& ring, std::size_t devices, double rate_hz, Keeps keeps, Log warn);

  /// Takes all records that are in the ring now.
  void drain();

  /// After the last drain: completes the trace and the recording. Errors: file_or_device.
  [[nodiscard]] Result<void> finish();

  /// How often the black box was written.
  [[nodiscard]] std::uint64_t black_boxes() const {
    return keeps_.black_box ? keeps_.black_box->written() : 0;
  }
  [[nodiscard]] Summary wake_us() const { return wake_.summary_us(); }
  [[nodiscard]] Summary busy_us() const { return busy_.summary_us(); }

 private:
  void take(const TickRecord& record);
  void keep(const RecordingRow& row);

  TickRing& ring_;
  double rate_hz_;
  Keeps keeps_;
  bool full_reported_ = false;
  Log warn_;
  DurationHistogram wake_, busy_;
  std::vector<ForceOff> last_cause_;
};

}  // namespace spm::servo
