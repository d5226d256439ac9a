// SPDX-License-Identifier: Apache-2.0
#include "servo/devices/base/latest_value.hpp"

#include <algorithm>
#include <atomic>
#include <catch2/catch.hpp>
#include <thread>

namespace latest_value_test {

using namespace spm::servo;

namespace {

/// Long enough that a copy takes many instructions; all words are the same in one put.
struct Wide {
  std::array<std::uint64_t, 40> words{};

  [[nodiscard]] bool torn() const {
    return std::any_of(words.begin(), words.end(),
                       [this](std::uint64_t word) { return word != words[0]; });
  }
};

}  // namespace

TEST_CASE("Nothing is taken before anything was put, and nothing twice") {
  LatestValue<int> latest;
  int value = 7;
  REQUIRE_FALSE(latest.take(value));
  REQUIRE(value == 7);
  REQUIRE_FALSE(latest.is_fresh());
  latest.put(1);
  REQUIRE(latest.is_fresh());
  REQUIRE(latest.take(value));
  REQUIRE_FALSE(latest.is_fresh());
  REQUIRE(value == 1);
  REQUIRE_FALSE(latest.take(value));
  REQUIRE(value == 1);
}

TEST_CASE("Of several values the last is taken") {
  LatestValue<int> latest;
  for (int count = 1; count < 10; ++count) {
    for (int i = 0; i <= count; ++i) latest.put(100 * count + i);
    int value = 0;
    REQUIRE(latest.take(value));
    REQUIRE(value == 101 * count);
    REQUIRE_FALSE(latest.take(value));
  }
}

TEST_CASE("Between two threads no value is torn, none comes back, and the last arrives") {
  constexpr std::uint64_t values = 300000;
  LatestValue<Wide> latest;
  std::thread putter([&latest] {
    for (std::uint64_t i = 1; i <= values; ++i) {
      Wide value;
      value.words.fill(i);
      latest.put(value);
    }
  });
  std::uint64_t newest = 0;
  std::uint64_t torn = 0;
  std::uint64_t older = 0;
  while (newest < values) {
    Wide value;
    if (!latest.take(value)) {
      std::this_thread::yield();
      continue;
    }
    torn += value.torn() ? 1 : 0;
    older += value.words[0] <= newest ? 1 : 0;
    newest = value.words[0];
  }
  putter.join();
  REQUIRE(torn == 0);
  REQUIRE(older == 0);
  Wide value;
  REQUIRE_FALSE(latest.take(value));
}

}  // namespace latest_value_test
