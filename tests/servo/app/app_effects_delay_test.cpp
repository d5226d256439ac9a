// SPDX-License-Identifier: Apache-2.0
// What effects take from a hand follows the loop's delay.
#include <array>
#include <catch2/catch.hpp>

#include "servo/app/app_effects.hpp"
#include "servo/stabilize/matched_damping.hpp"
#include "tests/servo/support/shape_asset.hpp"

namespace app_effects_delay_test {

using namespace spm;
using namespace spm::servo;

TEST_CASE("A spring that was set before the delay grew brakes as the new delay asks for") {
  constexpr double tick = 1e-3, stiffness = 100, speed = 0.01;  // s, N/m, m/s
  const Asset box = test::box_asset(0.04);
  const AssetTables tables = tables_of(box);
  const std::array<const AssetView*, 1> assets{&tables.view()};
  SceneForce force(scene_of({}), tick, 0);
  AppEffects effects;
  effects.know_device(0, {1000, 4, 900}, 0, tick, 1);
  AppCommand spring;
  spring.action = AppAction::effect;
  spring.connection = 1;
  spring.effect.stiffness = stiffness;
  REQUIRE(effects.set(spring, 0, 0) == Refusal::none);
  std::int64_t now = 0;
  double z = 0.1;
  // N against a steady motion, beside the spring's own pull.
  const auto braking = [&] {
    double felt = 0;
    for (int i = 0; i < 300; ++i) {
      now += 1'000'000;
      z -= speed * tick;
      felt = effects.next(0, {0, 0, z}, 1, now, force, assets).force.z() + stiffness * z;
    }
    return felt;
  };
  CHECK(braking() == Approx(matched_damping(1, stiffness, 1, tick) * speed).epsilon(0.02));
  effects.set_delay(0, 4, 900);
  CHECK(braking() == Approx(matched_damping(1, stiffness, 4, tick) * speed).epsilon(0.02));
}

}  // namespace app_effects_delay_test
