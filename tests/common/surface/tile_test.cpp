// SPDX-License-Identifier: Apache-2.0
#include "common/surface/tile.hpp"

#include <catch2/catch.hpp>
#include <limits>

namespace spm::tile_test {

TEST_CASE("Every HALF number survives the way through a float") {
  for (std::uint32_t bits = 0; bits < 0x10000; ++bits) {
    const auto half = static_cast<std::uint16_t>(bits);
    const std::uint32_t exponent = (bits >> 10U) & 0x1FU;
    if (exponent == 0x1F || (exponent == 0 && (bits & 0x3FFU) != 0)) continue;
    REQUIRE(float_to_half(half_to_float(half)) == half);
  }
  CHECK(half_to_float(0x3C00) == 1.0F);
  CHECK(half_to_float(0xC000) == -2.0F);
  CHECK(half_to_float(0x7BFF) == 65504.0F);
}

TEST_CASE("A float becomes the nearest HALF, ties the even one") {
  CHECK(float_to_half(1 + 0x1p-11F) == 0x3C00);
  CHECK(float_to_half(1 + 3 * 0x1p-11F) == 0x3C02);
  CHECK(float_to_half(1 + 1.01F * 0x1p-11F) == 0x3C01);
  CHECK(float_to_half(-1e9F) == 0xFBFF);
  CHECK(float_to_half(0x1p-15F) == 0);
  CHECK(float_to_half(std::numeric_limits<float>::quiet_NaN()) == 0);
}

TEST_CASE("A clip line survives packing to its steps") {
  const Clip clip = unpack_clip(pack_clip({-127, 33, -1.5F}));
  CHECK(clip.a == -127);
  CHECK(clip.b == 33);
  CHECK(clip.c == -1.5F);
  const Clip limited = unpack_clip(pack_clip({500, -500, 1e6F}));
  CHECK(limited.a == 127);
  CHECK(limited.b == -127);
  CHECK(limited.c == Approx(255).margin(1));
}

}  // namespace spm::tile_test
