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
