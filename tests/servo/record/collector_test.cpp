// SPDX-License-Identifier: Apache-2.0
#include "servo/record/collector.hpp"

#include <catch2/catch.hpp>

namespace collector_test {

using namespace spm::servo;

TEST_CASE("The ring takes its seconds of ticks of every device and then refuses without growing") {
  TickRing ring = make_tick_ring(1000, 2);
  const std::size_t capacity = ring.max_capacity();
  std::size_t taken = 0;
  while (ring.try_enqueue(TickRecord{})) ++taken;
  REQUIRE(taken >= static_cast<std::size_t>(2 * ring_seconds * 1000));
  REQUIRE(ring.max_capacity() == capacity);
}

TEST_CASE("The collector tells once when the force goes off and once when it is back") {
  TickRing ring = make_tick_ring(1000, 1);
  std::vector<std::string> messages;
  Collector collector(ring, 1, 1000, {},
                      [&](const std::string& message) { messages.push_back(message); });
  TickRecord record;
  for (std::uint64_t tick = 0; tick < 30; ++tick) {
    record.tick = tick;
    record.wake_ns = 1000;
    record.cause = tick >= 10 && tick < 20 ? ForceOff::asset_lost : ForceOff::none;
    REQUIRE(ring.try_enqueue(record));
  }
  collector.drain();
  REQUIRE(collector.finish());
  REQUIRE(messages.size() == 2);
  REQUIRE(messages[0].find("asset_lost") != std::string::npos);
  REQUIRE(messages[1].find("on again") != std::string::npos);
  REQUIRE(collector.wake_us().p50 == Approx(1.0).epsilon(0.01));
}

TEST_CASE("A device whose force comes and goes all the time is told of now and then") {
  TickRing ring = make_tick_ring(1000, 2);
  std::vector<std::string> messages;
  Collector collector(ring, 2, 1000, {},
                      [&](const std::string& message) { messages.push_back(message); });
  constexpr std::uint64_t seconds = 60;
  TickRecord record;
  for (record.tick = 0; record.tick < seconds * 1000; ++record.tick) {
    record.device = 1;
    record.cause = record.tick % 20 < 10 ? ForceOff::device_silent : ForceOff::none;
    REQUIRE(ring.try_enqueue(record));
    collector.drain();
  }
  const auto most =
      static_cast<std::size_t>(Collector::most_lines + seconds / Collector::line_seconds);
  CHECK(messages.size() >= most - 1);
  CHECK(messages.size() <= most + 1);
  CHECK(messages.back().find("changes before that were not told") != std::string::npos);
  // Another device is told of all the same.
  record.device = 0;
  record.cause = ForceOff::asset_lost;
  REQUIRE(ring.try_enqueue(record));
  collector.drain();
  CHECK(messages.back().find("device 0: the force is off, asset_lost") != std::string::npos);
  // And so is the first after a rest.
  record.device = 1;
  record.tick += 1'000'000;
  REQUIRE(ring.try_enqueue(record));
  collector.drain();
  CHECK(messages.back().find("device 1: the force is off, asset_lost") != std::string::npos);
}

TEST_CASE("Stopping is no event to warn of") {
  TickRing ring = make_tick_ring(1000, 1);
  int messages = 0;
  Collector collector(ring, 1, 1000, {}, [&](const std::string&) { ++messages; });
  TickRecord record;
  record.cause = ForceOff::stopping;
  REQUIRE(ring.try_enqueue(record));
  collector.drain();
  REQUIRE(messages == 0);
}

}  // namespace collector_test
