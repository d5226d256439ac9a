// SPDX-License-Identifier: GPL-3.0-or-later
#include <numbers>

#include "tests/stability/catalogue/catalogue.hpp"
#include "tests/stability/catalogue/catalogue_parts.hpp"
#include "tests/stability/catalogue/catalogue_shapes.hpp"

namespace spm::stability {
namespace {

/// m/s: 2 um a tick, so that what a sum of forces times ways is off by where the force jumps (half
/// of the jump times the way) stays small beside what is looked for.
constexpr double carried_speed = 2e-3;

/// The tool is carried from `start`, which is free, to the first corner, then twice round them, and
/// back out. Readings are exact and forces come at once, so that the field alone is judged.
StabilityCase loop_case(std::string name, std::string title, test::Shape shape,
                        const Vector3& start, const std::vector<Vector3>& corners) {
  constexpr int rounds = 2;
  StabilityCase made;
  made.theme = "loops";
  made.name = std::move(name);
  made.title = std::move(title);
  made.shape = std::move(shape);
  made.start = start;
  made.is_carried = true;
  made.hand.push_back({corners.front(), carried_speed, 0});
  for (int round = 0; round < rounds; ++round) {
    for (std::size_t i = 1; i <= corners.size(); ++i) {
      made.hand.push_back({corners[i % corners.size()], carried_speed, 0});
    }
  }
  made.hand.push_back({start, carried_speed, 0});
  made.seconds = script_seconds(made);
  made.delay_ticks = 0;
  made.encoder_step = 0;
  made.max_depth = 2e-3;
  made.tolerance = 30e-6;
  made.judged = {.ripple = false, .pop = false, .energy = true, .settles = false};
  made.judged.max_gained = 10e-6;
  return made;
}

}  // namespace

std::vector<StabilityCase> loop_cases() {
  constexpr double y = -2.1e-3, radius = 10e-3;  // m
  return {
      loop_case("loop-about-edge",
                "The tool is led twice round a closed path of 5 mm below a block's edge: where one "
                "face hands over to the other, a force that is no energy's gains on every round.",
                flat_block(), {29e-3, y, 1.5e-3},
                {{28.6e-3, y, -0.3e-3},
                 {29.8e-3, y, -0.3e-3},
                 {29.8e-3, y, -1.5e-3},
                 {28.6e-3, y, -1.5e-3}}),
      loop_case("loop-on-facets",
                "The tool is led twice round a closed path of 5 mm in a wall of 1 mm facets: a "
                "direction that switches with the facet gains on every round.",
                faceted_wall(35e-6, 1), {0.2e-3, 0.3e-3, 1.5e-3},
                {{0.2e-3, 0.3e-3, -0.2e-3},
                 {1.4e-3, 0.3e-3, -0.2e-3},
                 {1.4e-3, 1.5e-3, -0.6e-3},
                 {0.2e-3, 1.5e-3, -0.6e-3}}),
      loop_case("loop-under-groove",
                "The tool is led twice round a closed path of 5 mm below the tip of a groove of 90 "
                "degrees: there the direction turns from one wall's to the other's.",
                groove(std::numbers::pi / 2, 6e-3), {0, y, -4e-3},
                {{0, y, -6.2e-3}, {0.9e-3, y, -6.3e-3}, {0, y, -7.7e-3}, {-0.9e-3, y, -6.3e-3}}),
      loop_case("loop-in-ball",
                "The tool is led twice round a closed path of 5 mm in a ball of 320 facets: each "
                "has its own direction, and their errors must not add up.",
                test::sphere(radius, 2), {0, 0, radius + 1.5e-3},
                {{0.1e-3, 0.2e-3, 9.5e-3},
                 {1.4e-3, 0.2e-3, 9.4e-3},
                 {1.4e-3, 1.5e-3, 9.0e-3},
                 {0.1e-3, 1.5e-3, 9.2e-3}}),
  };
}

}  // namespace spm::stability
