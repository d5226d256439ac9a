// SPDX-License-Identifier: GPL-3.0-or-later
#include <fmt/format.h>

#include <array>
#include <cmath>

#include "tests/stability/catalogue/catalogue.hpp"
#include "tests/stability/catalogue/catalogue_parts.hpp"
#include "tests/stability/catalogue/catalogue_shapes.hpp"

namespace spm::stability {
namespace {

/// Away from symmetries; the depth in a thin object is never more than half of it, so that a band
/// of 2 mm holds all.
constexpr double place_x = 1.3e-3, place_y = -2.1e-3;  // m
constexpr double thin_band = 2e-3;                     // m

StabilityCase plate_case(int micrometres, int millimetres_a_second) {
  const double speed = millimetres_a_second * 1e-3;
  StabilityCase made = press_case(
      "thin", fmt::format("plate-{}um-at-{}-mm-s", micrometres, millimetres_a_second),
      fmt::format("A plate of {:g} mm is met at {:g} m/s and pressed with 2 N: deeper than half of "
                  "it the nearest side is the far one, and a depth alone pushes the hand through.",
                  micrometres * 1e-3, speed),
      flat_plate(micrometres * 1e-6), {.place = {place_x, place_y, 0}, .speed = speed});
  made.max_depth = thin_band;
  return made;
}

StabilityCase taper_case() {
  StabilityCase made = press_case(
      "thin", "taper",
      "The hand presses the flat side of a wedge with 2 N where it is 3.4 mm thick, and slides at "
      "0.05 m/s to where it is 0.9 mm: on the way it becomes too thin for a depth to hold.",
      taper(4e-3, 0.4e-3), {.place = {-10e-3, place_y, 0}, .rest = 0.5});
  made.hand.push_back({made.hand.front().to + Vector3(20.8e-3, 0, 0), default_speed, default_rest});
  made.seconds = script_seconds(made);
  made.max_depth = thin_band;
  return made;
}

}  // namespace

std::vector<StabilityCase> thin_cases() {
  std::vector<StabilityCase> cases;
  for (const int micrometres : {200, 500, 1000}) {
    for (const int speed : {50, 200, 500, 1000}) cases.push_back(plate_case(micrometres, speed));
  }
  cases.push_back(press_case(
      "thin", "two-plates",
      "Two plates of 1 mm lie 0.5 mm apart, and the upper one is pressed with 2 N: pushed through "
      "the first, a hand is caught between them or in the second.",
      two_plates(1e-3, 0.5e-3), {.place = {place_x, place_y, 0}}));
  cases.back().max_depth = thin_band;
  cases.push_back(press_case("thin", "bar-3mm",
                             "A bar of 3 x 3 mm is pressed with 2 N, 0.5 mm beside its middle: "
                             "below 1 mm the nearest side "
                             "is one beside, and a depth alone throws the hand off.",
                             square_bar(3e-3), {.place = {0.5e-3, place_y, 0}}));
  cases.back().max_depth = thin_band;
  cases.push_back(taper_case());
  return cases;
}

}  // namespace spm::stability
