// SPDX-License-Identifier: Apache-2.0
#include "servo/base/schedule.hpp"

#include <catch2/catch.hpp>

#include "common/base/random.hpp"

namespace schedule_test {

using spm::servo::TickSchedule;

TEST_CASE("Ticks in time follow one another on the grid") {
  TickSchedule schedule(1000, 1000);
  REQUIRE(schedule.due() == 1000);
  REQUIRE(schedule.advance(500'000) == 0);
  REQUIRE(schedule.index() == 1);
  REQUIRE(schedule.due() == 1'001'000);
}

TEST_CASE("After an overrun the schedule goes to the next future tick on the same grid") {
  TickSchedule schedule(0, 1000);
  REQUIRE(schedule.advance(5'300'000) == 5);
  REQUIRE(schedule.index() == 6);
  REQUIRE(schedule.due() == 6'000'000);
}

TEST_CASE("A tick that is due at this very moment is late") {
  TickSchedule schedule(0, 1000);
  REQUIRE(schedule.advance(1'000'000) == 1);
  REQUIRE(schedule.due() == 2'000'000);
}

TEST_CASE("Whatever the delays, every tick is later than the last and in the future") {
  for (const double rate : {500.0, 1000.0, 3000.0, 4000.0}) {
    spm::Random random(7);
    TickSchedule schedule(123'456'789, rate);
    std::int64_t now = 123'456'789;
    std::uint64_t skipped = 0;
    std::uint64_t ran = 0;
    for (int i = 0; i < 10'000; ++i) {
      now = std::max(now, schedule.due()) + static_cast<std::int64_t>(random.between(0, 3e6));
      const std::uint64_t before = schedule.index();
      skipped += schedule.advance(now);
      ++ran;
      REQUIRE(schedule.index() > before);
      REQUIRE(schedule.due() > now);
      REQUIRE(static_cast<double>(schedule.due() - now) <= schedule.period_ns() + 1);
    }
    REQUIRE(ran + skipped == schedule.index());
  }
}

}  // namespace schedule_test
