// SPDX-License-Identifier: Apache-2.0
// How an object goes over into what its settings are now.
#include "servo/force/felt_object.hpp"

#include <algorithm>
#include <catch2/catch.hpp>
#include <cmath>

#include "common/base/smooth_change.hpp"

namespace spm::felt_object_test {

TEST_CASE("Another pattern of texture comes once the old one is flat, each as fast as one change") {
  PlacedObject begun, wanted;
  begun.effects.texture = {50e-6, 1e-3, 7};
  wanted.effects.texture = {40e-6, 2e-3, 8};
  PlacedObject felt = begun;
  constexpr double tick = 1e-3;
  int ticks = 0;
  for (; !feels_the_same(felt, wanted); ++ticks) {
    REQUIRE(ticks < 1000);
    const TextureSettings before = felt.effects.texture;
    step_towards(felt, begun, wanted, tick, 0);
    const TextureSettings& now = felt.effects.texture;
    if (now.seed != before.seed) REQUIRE(now.amplitude == 0);
    const double whole =
        now.seed == wanted.effects.texture.seed ? 40e-6 : 50e-6;  // m, of the change under way
    REQUIRE(std::abs(now.amplitude - before.amplitude) <=
            std::max(whole, before.seed == 7 ? 50e-6 : 0) * tick / change_seconds * (1 + 1e-9));
  }
  CHECK(ticks == Approx(2 * change_seconds / tick).margin(2));
}

}  // namespace spm::felt_object_test
