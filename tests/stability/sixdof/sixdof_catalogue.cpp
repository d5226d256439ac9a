// SPDX-License-Identifier: GPL-3.0-or-later
#include <algorithm>
#include <cmath>
#include <numbers>
#include <utility>

#include "tests/stability/catalogue/sixdof_shapes.hpp"
#include "tests/stability/sixdof/sixdof_case.hpp"

namespace spm::stability {

namespace {

using Eigen::Isometry3d;

/// s. A loose grip's own swing has a time constant of 0.5 s; it is over before the hold begins.
constexpr double dropped_seconds = 4;

/// How far a shape reaches below its origin when it is turned, m.
double depth_below(const test::Shape& shape, const Vector3& turn) {
  const Eigen::Quaterniond orientation = orientation_of(turn);
  double lowest = 0;
  for (const Vector3& vertex : shape.vertices) {
    lowest = std::min(lowest, (orientation * vertex).z());
  }
  return -lowest;
}

/// A round peg, 6 mm thick, is led into a blind hole with 0.15 mm of play. At the mouth it is
/// tilted by 6 degrees; then it is pushed to the floor and against the wall.
SixdofCase peg_in_hole() {
  constexpr double radius = 3e-3, play = 0.15e-3;
  constexpr int around = 24;
  SixdofCase made;
  made.name = "peg-in-hole";
  made.title =
      "A peg enters a hole tilted and is pushed to its floor and wall: contacts on both "
      "sides at once";
  made.tool = test::cylinder(radius, 16e-3, around);
  made.object = block_with_hole(radius + play, 10e-3, 9e-3, 14e-3, around);
  made.places = {Isometry3d::Identity()};
  made.start = pose_of({0.3e-3, 0, 10e-3}, {0.105, 0, 0});
  made.hand = {{{0.3e-3, 0, 7e-3}, {0.105, 0, 0}, 0.03},
               {{0, 0, 5e-3}, {0, 0, 0}, 0.03},
               {{0, 0, -2e-3}, {0, 0, 0}, 0.03, 0.5, 0.1},
               {{16e-3, 0, -10e-3}, {0, 0.03, 0}, 0.05}};
  made.seconds = 2.8;
  made.normal = -Vector3::UnitX();
  made.touch = pose_of({play, 0, 0});
  made.press = Vector3::UnitX();
  made.judged.longest_penetration = 2.5e-3;
  return made;
}

/// Two blocks whose faces lean 15 degrees out of the upright, the gap between them closing
/// downward; a box of 8 mm is pressed into it, tilted.
SixdofCase wedged_tool() {
  constexpr double lean = std::numbers::pi / 12, gap = 5.2e-3;
  const Vector3 block(12e-3, 24e-3, 32e-3), tool(8e-3, 10e-3, 10e-3);
  SixdofCase made;
  made.name = "tool-wedged";
  made.title =
      "A box is pressed into the narrowing gap between two blocks: each side feeds the "
      "other";
  made.tool = test::box(tool);
  made.object = test::box(block);
  for (const double side : {1.0, -1.0}) {
    Isometry3d place = pose_of({side * gap, 0, 0}, {0, side * lean, 0});
    place.translate(Vector3(side * block.x() / 2, 0, 0));
    made.places.push_back(place);
  }
  made.start = pose_of({0.5e-3, 0, 16e-3}, {0, 0.15, 0});
  made.hand = {{{0, 0, 3e-3}, {0, 0.1, 0}, 0.05}, {{0, 0, -19e-3}, {0, 0.03, 0}, 0.05}};
  made.seconds = 2.8;
  made.touch = pose_of({gap - tool.x() / 2, 0, tool.z() / 2});
  made.press = Vector3(std::cos(lean), 0, -std::sin(lean));
  made.judged.longest_penetration = 5e-3;
  return made;
}

/// A flat tool of 30 mm with three times the device's mass, on bumps of 0.4 mm: it is put down,
/// pushed on by 4 mm and held.
SixdofCase heavy_tool() {
  constexpr double bump = 0.4e-3, thickness = 6e-3;
  SixdofCase made;
  made.name = "heavy-tool-many-contacts";
  made.title = "A heavy flat tool lies on a bumpy plate: stiffness adds up over many contacts";
  made.tool = test::box({30e-3, 30e-3, thickness});
  made.object = bumpy_plate(40e-3, 12e-3, bump, 4, 16);
  made.places = {Isometry3d::Identity()};
  made.spacing = 1.5e-3;
  const double rest = thickness / 2 + bump;
  made.start = pose_of({0, 0, rest + 3e-3}, {0.05, 0.03, 0});
  made.hand = {{{0, 0, rest - 5e-3}, {0.01, 0, 0}, 0.03, 0.5, 0.2},
               {{4e-3, 0, rest - 5e-3}, {0.01, 0, 0}, 0.02}};
  made.seconds = 2.8;
  made.mass_scale = 3;
  made.has_weight = true;
  made.touch = pose_of({0, 0, rest});
  made.judged.longest_penetration = 5e-3;
  return made;
}

/// A loosely held box with twice the device's mass falls on a plate, tilted by 35 degrees, so that
/// its own edge meets the plate at 0.5 m/s.
SixdofCase dropped_on_its_edge() {
  SixdofCase made;
  made.name = "tool-dropped-on-its-edge";
  made.title =
      "A loosely held box falls on a plate with its edge first: few contacts, an impact "
      "that turns it";
  made.tool = test::box({16e-3, 16e-3, 6e-3});
  made.object = test::moved(test::box({40e-3, 40e-3, 12e-3}), {0, 0, -6e-3});
  made.places = {Isometry3d::Identity()};
  const Vector3 turn(0.1, 0.61, 0);
  const double rest = depth_below(made.tool, turn);
  made.start = pose_of({0, 0, rest + 13e-3}, turn);
  made.hand = {{{0, 0, rest - 10e-3}, turn, 0.5}};
  made.seconds = dropped_seconds;
  made.mass_scale = 2;
  made.has_weight = true;
  made.grip_share = 0.2;
  made.touch = pose_of({0, 0, rest}, turn);
  made.judged.longest_penetration = 5e-3;
  return made;
}

/// The same box in a firm hand, without a weight, is set down on its edge at 0.2 m/s.
SixdofCase set_on_its_edge() {
  SixdofCase made = dropped_on_its_edge();
  made.name = "tool-set-on-its-edge";
  made.title = "A firmly held box is set down with its edge first: few contacts";
  made.hand.front().speed = 0.2;
  made.seconds = 3;
  made.mass_scale = 1;
  made.has_weight = false;
  made.grip_share = 1;
  return made;
}

/// The same box falls flat across a ridge of 60 degrees, 2 mm beside its middle.
SixdofCase dropped_across_an_edge() {
  constexpr double thickness = 6e-3;
  SixdofCase made;
  made.name = "tool-dropped-across-an-edge";
  made.title = "A loosely held box falls flat across a ridge: a line of contact beside its middle";
  made.tool = test::box({16e-3, 16e-3, thickness});
  made.object = test::wedge(std::numbers::pi / 3, 30e-3);
  made.places = {pose_of(Vector3::Zero(), {0, -std::numbers::pi / 2, 0})};
  const double rest = thickness / 2;
  made.start = pose_of({0, 2e-3, rest + 13e-3});
  made.hand = {{{0, 2e-3, rest - 10e-3}, Vector3::Zero(), 0.5}};
  made.seconds = dropped_seconds;
  made.mass_scale = 2;
  made.has_weight = true;
  made.grip_share = 0.2;
  made.touch = pose_of({0, 2e-3, rest});
  made.judged.longest_penetration = 5e-3;
  return made;
}

}  // namespace

std::vector<SixdofCase> sixdof_catalogue() {
  std::vector<SixdofCase> all{peg_in_hole(),         wedged_tool(),     heavy_tool(),
                              dropped_on_its_edge(), set_on_its_edge(), dropped_across_an_edge()};
  for (SixdofCase& one : thin_sixdof_cases()) all.push_back(std::move(one));
  all.push_back(handed_case());
  return all;
}

}  // namespace spm::stability
