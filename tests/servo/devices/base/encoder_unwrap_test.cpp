// SPDX-License-Identifier: Apache-2.0
#include "servo/devices/base/encoder_unwrap.hpp"

#include <algorithm>
#include <catch2/catch.hpp>

#include "common/base/random.hpp"

namespace encoder_unwrap_test {

using namespace spm::servo;
using spm::Random;

TEST_CASE("The first count is taken as it is, also after a reset") {
  EncoderUnwrap unwrap;
  REQUIRE(unwrap.next(-1234) == -1234);
  REQUIRE(unwrap.next(-1200) == -1200);
  unwrap.reset();
  REQUIRE(unwrap.next(32767) == 32767);
}

TEST_CASE("A counter that passes its end counts on, either way and several times") {
  EncoderUnwrap unwrap;
  std::int64_t expected = 32000;
  REQUIRE(unwrap.next(32000) == expected);
  for (int i = 0; i < 20; ++i) {
    expected += 10000;
    REQUIRE(unwrap.next(static_cast<std::int16_t>(expected)) == expected);
  }
  for (int i = 0; i < 60; ++i) {
    expected -= 10000;
    REQUIRE(unwrap.next(static_cast<std::int16_t>(expected)) == expected);
  }
  REQUIRE(expected < -300000);
}

TEST_CASE("Half the range less one count is a step, either way") {
  EncoderUnwrap unwrap;
  REQUIRE(unwrap.next(0) == 0);
  REQUIRE(unwrap.next(32767) == 32767);
  REQUIRE(unwrap.next(0) == 0);
  REQUIRE(unwrap.next(-32767) == -32767);
}

TEST_CASE("Any walk with steps below half the range is followed exactly") {
  for (std::uint64_t seed = 1; seed <= 20; ++seed) {
    CAPTURE(seed);
    Random random(seed);
    const double longest = random.between(1, 32767);
    auto place = static_cast<std::int64_t>(random.between(-32768, 32767));
    EncoderUnwrap unwrap;
    bool same = unwrap.next(static_cast<std::int16_t>(place)) == place;
    for (int i = 0; i < 5000; ++i) {
      place += static_cast<std::int64_t>(random.between(-longest, longest));
      same = same && unwrap.next(static_cast<std::int16_t>(place)) == place;
    }
    REQUIRE(same);
  }
}

}  // namespace encoder_unwrap_test
