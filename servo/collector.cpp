// SPDX-License-Identifier: Apache-2.0
#include "servo/collector.hpp"

#include <fmt/format.h>

#include <utility>

namespace spm::servo {

Collector::Collector(TickRing& ring, std::size_t devices, double rate_hz,
                     std::optional<TraceCsv> trace, Log warn)
    : ring_(ring),
      rate_hz_(rate_hz),
      trace_(std::move(trace)),
      warn_(std::move(warn)),
      last_cause_(devices, ForceOff::none) {}

void Collector::drain() {
  TickRecord record;
  while (ring_.try_dequeue(record)) take(record);
}

void Collector::take(const TickRecord& record) {
  if (record.device == 0) {
    wake_.add(record.wake_ns);
    busy_.add(record.busy_ns);
    if (trace_) {
      TraceRow row;
      row.t = static_cast<double>(record.tick) / rate_hz_;
      row.position = record.position;
      row.force = record.force;
      row.depth = record.depth;
      row.contact = record.contact;
      trace_->append(row);
    }
  }
  ForceOff& last = last_cause_[record.device];
  const bool fault = record.cause != ForceOff::none && record.cause != ForceOff::stopping;
  if (record.cause != last && fault) {
    warn_(fmt::format("tick {}: device {}: the force is off, {}: {}", record.tick, record.device,
                      to_string(record.cause), cure_of(record.cause)));
  } else if (record.cause == ForceOff::none && last != ForceOff::none) {
    warn_(fmt::format("tick {}: device {}: the force is on again", record.tick, record.device));
  }
  last = record.cause;
}

Result<void> Collector::finish() {
  if (!trace_) return {};
  return trace_->commit();
}

}  // namespace spm::servo
