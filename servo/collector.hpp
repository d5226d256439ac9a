// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <functional>
#include <optional>
#include <string>
#include <vector>

#include "servo/statistics.hpp"
#include "servo/tick_record.hpp"
#include "servo/trace_csv.hpp"

namespace spm::servo {

/// The other end of the ring: turns the loop's records into statistics, log messages and, if asked,
/// a trace of the first device. Belongs to one thread, which may allocate, log and block.
class Collector {
 public:
  using Log = std::function<void(const std::string&)>;

  Collector(TickRing& ring, std::size_t devices, double rate_hz, std::optional<TraceCsv> trace,
            Log warn);

  /// Takes everything that is in the ring now.
  void drain();

  /// After the last drain: writes the trace. Errors: file_or_device.
  [[nodiscard]] Result<void> finish();

  [[nodiscard]] Summary wake_us() const { return wake_.summary_us(); }
  [[nodiscard]] Summary busy_us() const { return busy_.summary_us(); }

 private:
  void take(const TickRecord& record);

  TickRing& ring_;
  double rate_hz_;
  std::optional<TraceCsv> trace_;
  Log warn_;
  DurationHistogram wake_, busy_;
  std::vector<ForceOff> last_cause_;
};

}  // namespace spm::servo
