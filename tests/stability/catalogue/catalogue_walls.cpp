// SPDX-License-Identifier: GPL-3.0-or-later
#include "tests/stability/catalogue/catalogue.hpp"
#include "tests/stability/catalogue/catalogue_parts.hpp"
#include "tests/stability/catalogue/catalogue_shapes.hpp"

namespace spm::stability {
namespace {

/// Away from the wall's symmetries.
constexpr double place_x = 1.3e-3, place_y = -2.1e-3;  // m

StabilityCase wall_case(std::string name, std::string title, double speed = default_speed) {
  StabilityCase made = press_case("walls", std::move(name), std::move(title), flat_block(),
                                  {.place = {place_x, place_y, 0}, .speed = speed});
  // What a device of 3.3 N lets through of a tap at 0.5 m/s.
  made.max_depth = 15e-3;
  return made;
}

StabilityCase of_border(std::string name, std::string title, double share) {
  StabilityCase made = wall_case(std::move(name), std::move(title));
  made.of_border = share;
  return made;
}

StabilityCase press_slide_lift() {
  constexpr int rounds = 3;
  StabilityCase made = wall_case(
      "press-slide-lift",
      "The hand presses a flat wall with 2 N, slides 10 mm at 0.1 m/s, lifts and comes back, three "
      "times, and then holds: energy that a round gains adds up.");
  const Vector3 above = made.start;
  const Vector3 below = made.hand.front().to;
  const Vector3 slide(10e-3, 0, 0);
  std::vector<HandLeg> legs;
  for (int round = 0; round < rounds; ++round) {
    legs.push_back({below, default_speed, 0.3});
    legs.push_back({below + slide, 0.1, 0.1});
    legs.push_back({above + slide, 0.1, 0});
    legs.push_back({above, 0.1, 0});
  }
  legs.push_back({below, default_speed, default_rest});
  made.hand = legs;
  made.seconds = script_seconds(made);
  return made;
}

StabilityCase noisy_wall() {
  StabilityCase made = wall_case(
      "noisy-flat-wall",
      "A flat wall is held with 2 N, the reading is noisy by 10 um and the device has no friction "
      "that hides it: noise may feed an oscillation that a clean run does not show.");
  made.noise = 10e-6;
  made.friction_scale = 0;
  made.seeds = 30;
  return made;
}

StabilityCase tile_switched_wall() {
  // Corners up to 35 um high make squares of 1 mm tilt by up to about 0.1.
  StabilityCase made = press_case(
      "walls", "tile-switched-wall",
      "A wall of 1 mm facets, tilted by up to 0.1, is held with 2 N where six of them meet; the "
      "device has no friction: a direction that jumps from facet to facet drives the hand.",
      faceted_wall(35e-6, 1), {.place = {1e-3, -2e-3, 0}});
  made.noise = 5e-6;
  made.friction_scale = 0;
  made.seeds = 30;
  return made;
}

}  // namespace

std::vector<StabilityCase> wall_cases() {
  std::vector<StabilityCase> cases{
      wall_case("flat-wall",
                "A flat wall is pressed at 0.05 m/s and held with 2 N: beyond the border of the "
                "sampled loop it buzzes."),
      of_border("flat-wall-at-0-6",
                "A flat wall is held with 2 N at 0.6 of the device's own border: every sound "
                "method must hold it still.",
                0.6),
      of_border("flat-wall-at-1-7",
                "A flat wall is held with 2 N at 1.7 of the device's own border: it must buzz "
                "without a stabilizer, or the judges see nothing.",
                1.7),
      wall_case("delay-2-ticks",
                "A flat wall is held with 2 N while the force comes two ticks late: the border "
                "falls to three fifths of that at one tick."),
      wall_case("delay-4-ticks",
                "A flat wall is held with 2 N while the force comes four ticks late: the border "
                "falls to a third of that at one tick."),
      wall_case(
          "encoder-100um",
          "A flat wall is held with 2 N by encoders with steps of 100 um: each step is a jump "
          "of the force, and a velocity taken from them is worthless."),
      wall_case("tap-at-500-mm-s",
                "The hand taps a flat wall at 0.5 m/s and stays: the fast way in makes each tick's "
                "leak of energy large, and the wall bounces.",
                0.5),
      press_slide_lift(),
      noisy_wall(),
      tile_switched_wall(),
  };
  for (StabilityCase& one : cases) {
    if (one.name == "delay-2-ticks") one.delay_ticks = 2;
    if (one.name == "delay-4-ticks") one.delay_ticks = 4;
    if (one.name == "encoder-100um") one.encoder_step = 100e-6;
  }
  return cases;
}

}  // namespace spm::stability
