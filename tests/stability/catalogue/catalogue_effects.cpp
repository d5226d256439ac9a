// SPDX-License-Identifier: GPL-3.0-or-later
#include "tests/stability/catalogue/catalogue.hpp"
#include "tests/stability/catalogue/catalogue_parts.hpp"
#include "tests/stability/catalogue/catalogue_shapes.hpp"

namespace spm::stability {
namespace {

constexpr double place_x = 1.3e-3, place_y = -2.1e-3;  // m

/// 0.8 N on 2 N, by Coulomb's law as by eq. 17. What sticks and what slides are the same, so that a
/// true surface would not stick and slip either.
void give_friction(StabilityCase& made) {
  made.effects.friction.stick = 0.4;
  made.effects.friction.slide = 0.4;
  made.effects.friction_force = 0.8;
  made.by_the_letter = true;
}

StabilityCase friction_at_rest() {
  StabilityCase made = press_case(
      "effects", "friction-at-rest",
      "A flat wall with friction is held with 2 N and pulled sideways by less than the friction: a "
      "friction that goes by the last step's direction chatters with the encoders.",
      flat_block(), {.place = {place_x, place_y, 0}});
  made.hand.front().to.x() += press_depth(0.3);
  made.seconds = script_seconds(made);
  made.max_depth = 15e-3;
  give_friction(made);
  return made;
}

StabilityCase slow_friction() {
  StabilityCase made = press_case(
      "effects", "friction-at-2-mm-s",
      "A flat wall with friction is pressed with 2 N and slid over at 2 mm/s to the end of the "
      "run: "
      "a tick's way is a tenth of an encoder's step, and the friction's direction is lost in it.",
      flat_block(), {.place = {place_x, place_y, 0}, .rest = 0.8});
  made.hand.push_back({made.hand.front().to + Vector3(5e-3, 0, 0), 2e-3, 0});
  made.seconds = script_seconds(made);
  made.max_depth = 15e-3;
  made.judged.settles = false;
  give_friction(made);
  return made;
}

StabilityCase texture_at_rest() {
  StabilityCase made = press_case(
      "effects", "texture-at-rest",
      "A wall with a texture of 50 um is held with 2 N: it is to be silent under a hand that does "
      "not move, as noise on the map and a texture in space are.",
      flat_block(), {.place = {place_x, place_y, 0}});
  made.max_depth = 15e-3;
  made.effects.texture.amplitude = 50e-6;
  made.effects.texture.wavelength = 1e-3;
  made.effects.texture.seed = 1;
  made.effects.texture_noise = 50e-6;
  made.by_the_letter = true;
  return made;
}

}  // namespace

std::vector<StabilityCase> effect_cases() {
  return {friction_at_rest(), slow_friction(), texture_at_rest()};
}

}  // namespace spm::stability
