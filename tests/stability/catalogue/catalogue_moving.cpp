// SPDX-License-Identifier: GPL-3.0-or-later
#include <algorithm>
#include <cmath>

#include "tests/stability/catalogue/catalogue.hpp"
#include "tests/stability/catalogue/catalogue_parts.hpp"
#include "tests/stability/catalogue/catalogue_shapes.hpp"

namespace spm::stability {
namespace {

constexpr double place_x = 1.3e-3, place_y = -2.1e-3;  // m
/// s, when the object is moved: the hand is still by then; and how long it rests in all.
constexpr double moved_at = 1.5, long_rest = 4;

StabilityCase held_wall(std::string name, std::string title, double force) {
  StabilityCase made =
      press_case("moving", std::move(name), std::move(title), flat_block(),
                 {.place = {place_x, place_y, 0}, .force = force, .rest = long_rest});
  made.max_depth = 15e-3;
  return made;
}

/// Another asset whose surface is `height` (m) higher.
StabilityCase reload(std::string name, std::string title, double height) {
  StabilityCase made = held_wall(std::move(name), std::move(title), 1);
  made.surface = [height](double time) { return Vector3(0, 0, time < moved_at ? 0 : height); };
  made.is_exchanged = true;
  return made;
}

/// m, of an object that comes up by `way` at 0.1 m/s.
std::function<Vector3(double)> rising(double way) {
  return
      [way](double time) { return Vector3(0, 0, std::clamp(0.1 * (time - moved_at), 0.0, way)); };
}

StabilityCase object_into_hand() {
  StabilityCase made =
      held_wall("object-into-hand",
                "A wall that is held with 1 N comes 10 mm into the hand at 0.1 m/s and stops: its "
                "motion puts "
                "in energy, and a force that takes it for the hand's own is wrong.",
                1);
  made.surface = rising(10e-3);
  return made;
}

StabilityCase plate_into_hand() {
  StabilityCase made = press_case(
      "moving", "plate-into-hand",
      "A plate of 1 mm comes at 0.1 m/s into a hand that rests 3 mm above it, and pushes it up by "
      "17 mm: a proxy that stays where it was in the world is left on the wrong side.",
      flat_plate(1e-3), {.place = {place_x, place_y, 0}});
  made.max_depth = 2e-3;
  made.start = {place_x, place_y, 3e-3};
  made.hand = {{made.start, default_speed, long_rest}};
  made.surface = rising(20e-3);
  made.seconds = script_seconds(made);
  return made;
}

/// As near as a hand with three degrees of freedom comes to a contact that is resolved now finer,
/// now coarser: the asset in use is exchanged for one baked to 100 um, whose surface may lie as
/// much higher, ten times in a second.
StabilityCase coarser_level() {
  constexpr double tolerance = 100e-6, each = 0.1;
  constexpr int switches = 10;
  StabilityCase made = held_wall(
      "coarser-level-switch",
      "A wall is held with 2 N while its asset is exchanged for one of a tolerance of 100 um and "
      "back, ten times in a second: every switch steps the force, and may feed an oscillation.",
      default_press);
  made.surface = [](double time) {
    const double count = std::floor((time - moved_at) / each);
    const bool is_coarse = count >= 0 && count < switches && std::fmod(count, 2) == 0;
    return Vector3(0, 0, is_coarse ? tolerance : 0);
  };
  made.is_exchanged = true;
  return made;
}

}  // namespace

std::vector<StabilityCase> moving_cases() {
  return {reload("reload-by-500um",
                 "A wall that is held with 1 N is exchanged for one that is 0.5 mm higher: the "
                 "force steps, and throws the hand off.",
                 0.5e-3),
          reload("reload-by-2mm",
                 "A wall that is held with 1 N is exchanged for one that is 2 mm higher: the hand "
                 "is suddenly deep inside, and is shot out.",
                 2e-3),
          object_into_hand(), plate_into_hand(), coarser_level()};
}

}  // namespace spm::stability
