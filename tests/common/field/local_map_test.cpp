// SPDX-License-Identifier: Apache-2.0
#include "common/field/local_map.hpp"

#include <array>
#include <catch2/catch.hpp>
#include <cmath>
#include <cstdint>

#include "common/base/random.hpp"

namespace spm::local_map_test {
namespace {

/// A number of `bits` bits from a place in the words, with its sign.
int number(const std::array<std::uint32_t, 4>& words, unsigned at, unsigned bits) {
  const std::uint32_t word = words[at / 32] >> at % 32;
  const int value = static_cast<int>(word & ((1U << bits) - 1));
  return value < 1 << (bits - 1) ? value : value - (1 << bits);
}

TEST_CASE("Any words unpack to the numbers that their bits stand for") {
  Random random(11);
  const double value_unit = 3e-7;
  for (int trial = 0; trial < 5000; ++trial) {
    std::array<std::uint32_t, 4> words{};
    for (std::uint32_t& word : words) {
      word = static_cast<std::uint32_t>(random.between(0, 4294967296.0));
    }
    const LocalMap map = unpack_local_map(words.data(), value_unit);
    REQUIRE(map.value == value_unit * number(words, 0, 16));
    for (unsigned k = 0; k < 3; ++k) {
      REQUIRE(map.slope[k] == slope_unit * number(words, 16 * (k + 1), 16));
    }
    const int exponent = static_cast<int>(words[3] >> 16 & 0xFFU) - bend_exponent_bias;
    for (unsigned k = 0; k < 6; ++k) {
      REQUIRE(map.bend[k] == std::ldexp(number(words, 64 + 8 * k, 8), exponent));
    }
    REQUIRE(map.plane == words[3] >> 24);
  }
}

TEST_CASE("A map is packed with the finest unit in which its largest bend fits") {
  for (const int exponent : {-30, -9, 0, 3}) {
    LocalMap map;
    map.slope = {0.25, -0.5, 0.75};
    map.bend = {127, -127, 1, -1, 64, 0};
    for (double& bend : map.bend) bend = std::ldexp(bend, exponent);
    PackedLocalMap packed;
    REQUIRE(pack_local_map(map, 1e-6, packed));
    const LocalMap read = unpack_local_map(packed.words.data(), 1e-6);
    CHECK(read.bend == map.bend);
  }
}

}  // namespace
}  // namespace spm::local_map_test
