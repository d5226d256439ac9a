// SPDX-License-Identifier: Apache-2.0
#include "servo/record/collector.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <utility>

namespace spm::servo {

Collector::Collector(TickRing& ring, std::size_t devices, double rate_hz, Keeps keeps, Log warn)
    : ring_(ring),
      rate_hz_(rate_hz),
      keeps_(std::move(keeps)),
      warn_(std::move(warn)),
      told_(devices) {}

void Collector::drain() {
  TickRecord record;
  while (ring_.try_dequeue(record)) take(record);
}

void Collector::take(const TickRecord& record) {
  if (record.device == 0) {
    wake_.add(record.wake_ns);
    busy_.add(record.busy_ns);
    if (keeps_.trace) {
      TraceRow row;
      row.t = static_cast<double>(record.tick) / rate_hz_;
      row.position = record.hand.position;
      row.orientation = record.hand.orientation;
      row.force = record.sent.force;
      row.torque = record.sent.torque;
      row.depth = record.depth;
      row.contact = record.contact;
      row.tool = record.tool;
      row.patches = record.patches;
      row.level = record.effort.level;
      row.culled = record.effort.culled;
      row.force_capped = record.force_capped;
      row.torque_capped = record.torque_capped;
      row.tool_capped = record.tool_capped;
      keeps_.trace->append(row);
    }
  }
  if (keeps_.recorder) keeps_.recorder->take(to_row(record));
  ForceOff& last = told_[record.device].cause;
  const bool fault = record.cause != ForceOff::none && record.cause != ForceOff::stopping;
  if (record.cause != last && fault) {
    tell(record,
         fmt::format("the force is off, {}: {}", to_string(record.cause), cure_of(record.cause)));
  } else if (record.cause == ForceOff::none && last != ForceOff::none) {
    tell(record, "the force is on again");
  }
  last = record.cause;
}

void Collector::tell(const TickRecord& record, const std::string& what) {
  Told& told = told_[record.device];
  const double passed = static_cast<double>(record.tick - told.tick) / rate_hz_;
  told.lines = std::min(most_lines, told.lines + passed / line_seconds);
  told.tick = record.tick;
  if (told.lines < 1) {
    ++told.untold;
    return;
  }
  told.lines -= 1;
  const std::string more =
      told.untold > 0 ? fmt::format(" ({} changes before that were not told)", told.untold) : "";
  told.untold = 0;
  warn_(fmt::format("tick {}: device {}: {}{}", record.tick, record.device, what, more));
}

Result<void> Collector::finish() {
  Result<void> done;
  if (keeps_.trace) done = keeps_.trace->commit();
  if (keeps_.recorder) {
    auto recorded = keeps_.recorder->finish();
    if (done) done = std::move(recorded);
  }
  return done;
}

}  // namespace spm::servo
