// SPDX-License-Identifier: Apache-2.0
// HALF samples, as EXR files have them.
#include "common/base/half.hpp"

#include <catch2/catch.hpp>
#include <cmath>
#include <cstdint>

#include "tests/support/random.hpp"

namespace spm::half_test {

TEST_CASE("A half is the number that its bits say, and is the half nearest to itself") {
  for (std::uint16_t half = 0x0400; half < 0x7C00; ++half) {
    const int exponent = half >> 10, fraction = half & 0x3FF;
    const float number = float_of_half(half);
    REQUIRE(number == std::ldexp(static_cast<float>(1024 + fraction), exponent - 25));
    REQUIRE(half_of(number) == half);
  }
  CHECK(float_of_half(0x0400) == least_half);
  CHECK(float_of_half(0x7BFF) == largest_half);
}

TEST_CASE("A number becomes the half nearest to it, the even one of two") {
  test::RandomTwister random(11);
  for (int k = 0; k < 10000; ++k) {
    const auto number = static_cast<float>(std::exp2(random.between(-14, 15)));
    const std::uint16_t half = half_of(number);
    const auto off = [number](std::uint16_t other) {
      return std::abs(float_of_half(other) - number);
    };
    REQUIRE(off(half) <= off(static_cast<std::uint16_t>(half + 1)));
    if (half > 0x0400) REQUIRE(off(half) <= off(static_cast<std::uint16_t>(half - 1)));
  }
  CHECK(half_of(1 + 0x1p-11F) == half_of(1));
  CHECK(half_of(1 + 0x1p-10F + 0x1p-11F) == half_of(1 + 0x1p-9F));
}

}  // namespace spm::half_test
