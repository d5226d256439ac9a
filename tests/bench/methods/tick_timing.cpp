// SPDX-License-Identifier: GPL-3.0-or-later
#include "tests/bench/methods/tick_timing.hpp"

#include <algorithm>
#include <chrono>
#include <cmath>
#include <limits>

#include "tests/bench/base/quantile.hpp"
#include "tests/bench/base/timing.hpp"

namespace spm::bench {
namespace {

using TimingClock = std::chrono::steady_clock;

/// The least time of each tick so far, for one method.
struct Record {
  std::vector<double> least;
  std::size_t contacts = 0;
  double seconds = 0;
};

double seconds_from(TimingClock::time_point start) {
  return std::chrono::duration<double>(TimingClock::now() - start).count();
}

void time_pass(TickMethod& method, std::span<const Vector3> path, Record& record) {
  const TimingClock::time_point begin = TimingClock::now();
  method.start(path.front());
  record.contacts = 0;
  for (std::size_t i = 0; i < path.size(); ++i) {
    const TimingClock::time_point start = TimingClock::now();
    const bool contact = method.tick(i, path[i]);
    const double seconds = seconds_from(start);
    record.least[i] = std::min(record.least[i], seconds);
    record.contacts += contact && method.counts(i) ? 1 : 0;
  }
  record.seconds += seconds_from(begin);
}

TickTimes summary(const TickMethod& method, const Record& record, double clock) {
  std::vector<double> values;
  for (std::size_t i = 0; i < record.least.size(); ++i) {
    if (method.counts(i)) values.push_back(1e6 * std::max(0.0, record.least[i] - clock));
  }
  TickTimes times;
  times.ticks = values.size();
  times.contacts = record.contacts;
  if (values.empty()) return times;
  const auto count = static_cast<double>(values.size());
  for (const double value : values) times.mean += value / count;
  double squares = 0;
  for (const double value : values) squares += (value - times.mean) * (value - times.mean);
  times.sd = std::sqrt(squares / count);
  times.p50 = quantile(values, 0.5);
  times.p99 = quantile(values, 0.99);
  return times;
}

}  // namespace

std::vector<TickTimes> time_ticks(std::span<const std::unique_ptr<TickMethod>> methods,
                                  std::span<const Vector3> path, const TickPlan& plan) {
  const PinnedThread pinned;
  std::vector<Record> records(methods.size());
  for (Record& record : records) {
    record.least.assign(path.size(), std::numeric_limits<double>::infinity());
  }
  for (std::size_t pass = 0; pass < plan.passes; ++pass) {
    for (std::size_t i = 0; i < methods.size(); ++i) {
      if (pass >= plan.min_passes && records[i].seconds > plan.max_seconds) continue;
      time_pass(*methods[i], path, records[i]);
    }
  }
  const double clock = clock_seconds();
  std::vector<TickTimes> times;
  for (std::size_t i = 0; i < methods.size(); ++i) {
    times.push_back(summary(*methods[i], records[i], clock));
  }
  return times;
}

}  // namespace spm::bench
