// SPDX-License-Identifier: GPL-3.0-or-later
#include <fmt/format.h>

#include <cmath>
#include <numbers>

#include "tests/stability/catalogue/catalogue.hpp"
#include "tests/stability/catalogue/catalogue_parts.hpp"
#include "tests/stability/catalogue/catalogue_shapes.hpp"

namespace spm::stability {
namespace {

/// Beside the middle, so that no two walls are ever equally near; along the groove.
constexpr double beside = 0.1e-3, along = -2.1e-3;  // m
/// m: of the ball's centre, which comes into the solid only where the ball is 2 mm deep.
constexpr double ball_band = 2.5e-3;
/// m: about half of an encoder's step of the coarser devices; it keeps the bakes short.
constexpr double groove_tolerance = 30e-6;

StabilityCase groove_case(int degrees) {
  constexpr double depth = 6e-3;
  const double half = degrees * std::numbers::pi / 360;
  // Where the ball touches both walls.
  const double height = -depth + ball_radius / std::sin(half);
  StabilityCase made = press_case(
      "grooves", fmt::format("sphere-in-groove-{}", degrees),
      fmt::format("A ball of 2 mm is pressed with 2 N into a groove of {} degrees: pushed by the "
                  "nearest wall alone it is thrown from one to the other.",
                  degrees),
      groove(2 * half, depth), {.place = {beside, along, height}});
  made.probe_radius = ball_radius;
  made.max_depth = ball_band;
  return made;
}

StabilityCase slot_case() {
  // So deep that a ball that falls in is held by nothing.
  constexpr double width = 3e-3, depth = 22e-3;
  const double height = std::sqrt(ball_radius * ball_radius - width * width / 4);
  StabilityCase made = press_case(
      "grooves", "sphere-on-slot",
      "A ball of 2 mm is pressed with 2 N onto a slot of 3 mm that it does not fit into: once its "
      "middle is between the walls, the nearest one pushes it sideways only, and it falls in.",
      slot(width, depth), {.place = {beside, along, height}});
  made.probe_radius = ball_radius;
  made.max_depth = ball_band;
  return made;
}

StabilityCase corner_case() {
  StabilityCase made = press_case(
      "grooves", "sphere-in-corner",
      "A ball of 2 mm is pressed with 2 N into a corner of three walls: pushed by the nearest one "
      "alone it never rests on all three.",
      inner_corner(),
      {.place = Vector3::Constant(ball_radius), .normal = Vector3::Constant(1 / std::sqrt(3.0))});
  made.probe_radius = ball_radius;
  made.max_depth = ball_band;
  return made;
}

}  // namespace

std::vector<StabilityCase> groove_cases() {
  std::vector<StabilityCase> cases{
      groove_case(60),
      groove_case(90),
      groove_case(120),
      slot_case(),
      corner_case(),
      press_case("grooves", "cone-pit",
                 "A point is pressed with 2 N into the tip of a cone of 90 degrees: about the "
                 "tip the direction turns with every step of the encoders.",
                 cone_pit(4e-3), {.place = {0, 0, -4e-3}})};
  for (StabilityCase& one : cases) one.tolerance = groove_tolerance;
  return cases;
}

}  // namespace spm::stability
