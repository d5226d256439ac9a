// SPDX-License-Identifier: Apache-2.0
#include "servo/devices/base/report_signal.hpp"

#include <atomic>
#include <catch2/catch.hpp>
#include <limits>
#include <thread>

#include "servo/base/clock.hpp"

namespace report_signal_test {

using namespace spm::servo;

namespace {

constexpr std::int64_t millisecond = 1'000'000;
/// Later than any test runs.
std::int64_t much_later() { return now_ns() + 20'000 * millisecond; }

}  // namespace

TEST_CASE("A signal that was raised before is not waited for") {
  ReportSignal signal;
  const std::uint32_t seen = signal.count();
  signal.raise();
  REQUIRE(signal.wait(seen, much_later()));
  REQUIRE(signal.wait(seen, 0));
}

TEST_CASE("A signal that nobody raises is waited for until the time, not less") {
  ReportSignal signal;
  const std::int64_t until = now_ns() + 30 * millisecond;
  REQUIRE_FALSE(signal.wait(signal.count(), until));
  REQUIRE(now_ns() >= until);
}

TEST_CASE("A time that is past, or none at all, does not hang") {
  ReportSignal signal;
  for (const std::int64_t until :
       {std::int64_t{0}, std::int64_t{-1}, std::numeric_limits<std::int64_t>::min()}) {
    REQUIRE_FALSE(signal.wait(signal.count(), until));
  }
}

TEST_CASE("No raising is lost between looking and sleeping") {
  ReportSignal there, back;
  constexpr std::uint32_t rounds = 20'000;
  bool answered = true;
  std::thread other([&] {
    for (std::uint32_t i = 0; i < rounds && answered; ++i) {
      if (!there.wait(i, much_later())) answered = false;
      back.raise();
    }
  });
  bool woken = true;
  for (std::uint32_t i = 0; i < rounds && woken; ++i) {
    there.raise();
    woken = back.wait(i, much_later());
  }
  other.join();
  REQUIRE(woken);
  REQUIRE(answered);
}

}  // namespace report_signal_test
