// SPDX-License-Identifier: GPL-3.0-or-later
#include "tests/bench/base/timing.hpp"

#include <sched.h>

#include <algorithm>
#include <chrono>
#include <cstring>
#include <utility>

#include "tests/bench/base/quantile.hpp"

namespace spm::bench {
namespace {

using TimingClock = std::chrono::steady_clock;

constexpr std::size_t block_size = 64;

double seconds_between(TimingClock::time_point start, TimingClock::time_point end) {
  return std::chrono::duration<double>(end - start).count();
}

double median(std::vector<double> values) { return quantile(values, 0.5); }

std::span<const TimedPlace> block_of(std::span<const TimedPlace> places, std::size_t index) {
  const std::size_t first = index * block_size;
  return places.subspan(first, std::min(block_size, places.size() - first));
}

/// Seconds of one block, without the clock's.
double time_asking(Contestant& contestant, std::span<const TimedPlace> block, double clock) {
  const TimingClock::time_point start = TimingClock::now();
  contestant.ask(block);
  const double seconds = seconds_between(start, TimingClock::now());
  return std::max(0.0, seconds - clock);
}

double time_block(Contestant& contestant, std::span<const TimedPlace> block, double clock) {
  contestant.begin(block);
  return time_asking(contestant, block, clock);
}

/// Nanoseconds a query: the median of a pass's blocks, all of them or so many, evenly spread, as
/// the time of a pass allows. Rounds begin at different blocks.
double time_pass(Contestant& contestant, std::span<const TimedPlace> places, std::size_t round,
                 const TimingPlan& plan, double clock) {
  const std::size_t all = (places.size() + block_size - 1) / block_size;
  const double first = time_block(contestant, block_of(places, round % all), clock);
  const auto allowed = static_cast<std::size_t>(plan.pass_seconds / std::max(first, 1e-9));
  const std::size_t count = std::clamp(allowed, std::size_t{1}, all);
  std::vector<double> blocks;
  for (const bool warm : {false, true}) {
    for (std::size_t i = 0; i < count; ++i) {
      const auto block = block_of(places, (i * all / count + round) % all);
      const double seconds = time_block(contestant, block, clock);
      if (warm) blocks.push_back(1e9 * seconds / static_cast<double>(block.size()));
    }
  }
  return median(std::move(blocks));
}

/// Nanoseconds that 99 % of single queries along the path keep.
double time_single_queries(Contestant& contestant, std::span<const TimedPlace> places,
                           const TimingPlan& plan, double clock) {
  std::vector<double> least;
  const double allowed = plan.pass_seconds * static_cast<double>(plan.rounds);
  double taken = 0;
  for (std::size_t pass = 0; pass < plan.single_passes; ++pass) {
    for (std::size_t i = 0; i < places.size() && taken < allowed; ++i) {
      const auto place = places.subspan(i, 1);
      if (i > 0 && !places[i].fresh) {
        contestant.go_on(place);
      } else {
        contestant.begin(place);
      }
      const double seconds = time_asking(contestant, place, clock);
      taken += seconds;
      if (i == least.size()) least.push_back(seconds);
      least[i] = std::min(least[i], seconds);
    }
  }
  return 1e9 * quantile(least, 0.99);
}

/// Reads a buffer larger than the caches, so that they hold nothing else.
class CacheWalk {
 public:
  explicit CacheWalk(std::size_t bytes) : buffer_(bytes, 1) {}
  void operator()() {
    constexpr std::size_t line = 64;
    unsigned sum = 0;
    for (std::size_t i = 0; i < buffer_.size(); i += line) sum += buffer_[i]++;
    keep(sum);
  }

 private:
  std::vector<std::uint8_t> buffer_;
};

std::vector<double> medians_of(std::vector<std::vector<double>> passes) {
  std::vector<double> result;
  result.reserve(passes.size());
  for (std::vector<double>& values : passes) result.push_back(median(std::move(values)));
  return result;
}

}  // namespace

PinnedThread::PinnedThread() : before_(sizeof(cpu_set_t), 0) {
  cpu_set_t set;
  CPU_ZERO(&set);
  if (sched_getaffinity(0, sizeof set, &set) == 0) std::memcpy(before_.data(), &set, sizeof set);
  const int here = sched_getcpu();
  if (here < 0) return;
  CPU_ZERO(&set);
  CPU_SET(static_cast<unsigned>(here), &set);
  // A container may refuse it; then the figures are only noisier.
  static_cast<void>(sched_setaffinity(0, sizeof set, &set));
}

PinnedThread::~PinnedThread() {
  cpu_set_t set;
  std::memcpy(&set, before_.data(), sizeof set);
  if (CPU_COUNT(&set) > 0) static_cast<void>(sched_setaffinity(0, sizeof set, &set));
}

double clock_seconds() {
  std::vector<double> samples(1001);
  for (double& sample : samples) {
    const TimingClock::time_point start = TimingClock::now();
    sample = seconds_between(start, TimingClock::now());
  }
  return median(std::move(samples));
}

std::vector<double> time_hot(const std::vector<std::unique_ptr<Contestant>>& contestants,
                             std::span<const TimedPlace> places, const TimingPlan& plan) {
  const PinnedThread pinned;
  const double clock = clock_seconds();
  std::vector<std::vector<double>> passes(contestants.size());
  for (std::size_t round = 0; round < plan.rounds; ++round) {
    for (std::size_t i = 0; i < contestants.size(); ++i) {
      passes[i].push_back(time_pass(*contestants[i], places, round, plan, clock));
    }
  }
  return medians_of(std::move(passes));
}

std::vector<QueryTimes> time_queries(const std::vector<std::unique_ptr<Contestant>>& contestants,
                                     const QuerySets& sets, const TimingPlan& plan,
                                     const std::function<void(double done)>& progress) {
  const PinnedThread pinned;
  const double clock = clock_seconds();
  const std::size_t count = contestants.size();
  std::vector<std::vector<double>> hot(count), random(count), cold(count);
  std::vector<double> hot_p99;
  const auto steps = static_cast<double>(plan.rounds + plan.cold_queries);
  for (std::size_t round = 0; round < plan.rounds; ++round) {
    if (progress) progress(static_cast<double>(round) / steps);
    for (std::size_t i = 0; i < count; ++i) {
      hot[i].push_back(time_pass(*contestants[i], sets.hot, round, plan, clock));
    }
    for (std::size_t i = 0; i < count; ++i) {
      random[i].push_back(time_pass(*contestants[i], sets.random, round, plan, clock));
    }
  }
  for (const auto& contestant : contestants) {
    hot_p99.push_back(time_single_queries(*contestant, sets.hot, plan, clock));
  }
  CacheWalk walk(plan.cold_bytes);
  for (std::size_t query = 0; query < plan.cold_queries; ++query) {
    if (progress) progress(static_cast<double>(plan.rounds + query) / steps);
    const auto place = std::span(sets.random).subspan(query % sets.random.size(), 1);
    for (std::size_t i = 0; i < count; ++i) {
      contestants[i]->begin(place);
      walk();
      cold[i].push_back(1e9 * time_asking(*contestants[i], place, clock));
    }
  }
  const std::vector<double> hot_medians = medians_of(std::move(hot));
  const std::vector<double> random_medians = medians_of(std::move(random));
  const std::vector<double> cold_medians = medians_of(std::move(cold));
  std::vector<QueryTimes> times(count);
  for (std::size_t i = 0; i < count; ++i) {
    times[i] = {hot_medians[i], hot_p99[i], random_medians[i], cold_medians[i]};
  }
  return times;
}

}  // namespace spm::bench
