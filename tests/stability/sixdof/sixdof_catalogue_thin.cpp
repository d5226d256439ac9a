// SPDX-License-Identifier: GPL-3.0-or-later
#include <numbers>

#include "tests/stability/catalogue/sixdof_shapes.hpp"
#include "tests/stability/sixdof/sixdof_case.hpp"

namespace spm::stability {

namespace {

using Eigen::Isometry3d;

/// A box with four times the device's mass lies on a table for a minute. A loose hand pulls it
/// aside and turns it, with less than friction holds.
SixdofCase resting_tool() {
  constexpr double thickness = 6e-3;
  SixdofCase made;
  made.name = "tool-rests-a-minute";
  made.title =
      "A tool lies on a table for a minute, pulled aside by less than friction holds: it neither "
      "creeps nor spins";
  made.tool = test::box({16e-3, 16e-3, thickness});
  made.object = test::moved(test::box({40e-3, 40e-3, 12e-3}), {0, 0, -6e-3});
  made.places = {Isometry3d::Identity()};
  const double rest = thickness / 2;
  made.start = pose_of({0, 0, rest + 1e-3});
  made.hand = {{{0, 0, rest - 2e-3}, {0, 0, 0}, 0.02, 0.5, 0.5},
               {{15e-3, 0, rest - 2e-3}, {0, 0, 0.05}, 0.02}};
  made.seconds = 60;
  made.mass_scale = 4;
  made.has_weight = true;
  made.grip_share = 0.02;
  made.friction = 0.5;
  made.touch = pose_of({0, 0, rest});
  made.creep = {5, 0.1e-3, 0.01};
  made.judged.longest_penetration = 5e-3;
  made.seeds = 1;
  return made;
}

/// A bolt of 10 mm with a pitch of 3 mm in its nut, with 0.25 mm of play: it is pressed along its
/// axis and turned by 2.4 rad, so that the thread takes it along.
SixdofCase screwed_tool() {
  constexpr double play = 0.25e-3, turn = 1.2, press = 6e-3;
  Thread thread{5e-3, 0.5e-3, 3e-3, 4, 32, 8};
  SixdofCase made;
  made.name = "tool-screwed-in";
  made.title =
      "A bolt is turned in its nut while it is pressed along its axis: the thread takes it along";
  made.tool = bolt(thread);
  thread.radius += play;
  made.object = nut(thread, 9e-3);
  made.places = {Isometry3d::Identity()};
  made.tolerance = 20e-6;
  made.spacing = 0.5e-3;
  const double way = thread.pitch * turn / (2 * std::numbers::pi);
  made.start = pose_of({0, 0, -way}, {0, 0, -turn});
  made.hand = {{{0, 0, press - way}, {0, 0, -turn}, 0.03, 0.5, 0.3},
               {{0, 0, press}, {0, 0, 0}, 0.03, 1},
               {{0, 0, press + way}, {0, 0, turn}, 0.03, 1}};
  made.seconds = 4;
  made.normal = -Vector3::UnitZ();
  made.touch = pose_of({play, 0, 0});
  made.press = Vector3::UnitX();
  made.judged.longest_penetration = 0.5e-3;
  return made;
}

/// Two layers of bars, 0.8 mm thick and 3 mm apart; a box of 5 mm is pressed onto them, tilted, and
/// scraped across by 8 mm.
SixdofCase scraped_lattice() {
  constexpr double thickness = 0.8e-3;
  const Vector3 tool(5e-3, 5e-3, 8e-3);
  SixdofCase made;
  made.name = "tool-scrapes-lattice";
  made.title =
      "A tool is pressed onto a lattice of thin bars and scraped across: edges that catch, and "
      "parts thinner than the press";
  made.tool = test::box(tool);
  made.object = lattice(thickness, 3e-3, 8, 0.2e-3);
  made.places = {Isometry3d::Identity()};
  made.tolerance = 10e-6;
  made.max_depth = 1e-3;
  made.spacing = 0.5e-3;
  const double rest = tool.z() / 2;
  made.start = pose_of({-4e-3, -1e-3, rest + 3e-3}, {0.05, 0.15, 0.2});
  made.hand = {{{-4e-3, -1e-3, rest - 8e-3}, {0.05, 0.15, 0.2}, 0.05, 0.5, 0.2},
               {{4e-3, 1e-3, rest - 8e-3}, {-0.05, 0, -0.2}, 0.03, 1}};
  made.seconds = 2.8;
  made.touch = pose_of({0, 0, rest});
  made.compared_depth = 0.3e-3;
  made.judged.longest_penetration = 0.5e-3;
  return made;
}

/// A plate of 0.2 mm; a box of 10 mm, turned, is pulled at 1 m/s to 15 mm behind it.
SixdofCase pulled_through_plate() {
  constexpr double thickness = 0.2e-3;
  const Vector3 tool(10e-3, 10e-3, 4e-3);
  SixdofCase made;
  made.name = "tool-pulled-through-plate";
  made.title = "A turned tool is pulled through a plate of 0.2 mm at 1 m/s: it must not pass";
  made.tool = test::box(tool);
  made.object = test::moved(test::box({40e-3, 40e-3, thickness}), {0, 0, -thickness / 2});
  made.places = {Isometry3d::Identity()};
  // A corner lies as far from the next sample as samples lie apart, and is not to come out behind.
  made.spacing = 0.2e-3;
  made.tolerance = 10e-6;
  made.max_depth = 1e-3;
  const Vector3 turn(0.4, 0.3, 0.2);
  made.start = pose_of({0, 0, 15e-3}, turn);
  made.hand = {{{0, 0, -15e-3}, turn, 1}};
  made.seconds = 2.5;
  made.touch = pose_of({0, 0, tool.z() / 2});
  made.compared_depth = 0.08e-3;
  made.judged.longest_penetration = thickness;
  return made;
}

}  // namespace

std::vector<SixdofCase> thin_sixdof_cases() {
  return {resting_tool(), screwed_tool(), scraped_lattice(), pulled_through_plate()};
}

}  // namespace spm::stability
