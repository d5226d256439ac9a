// SPDX-License-Identifier: GPL-3.0-or-later
#include "tests/stability/catalogue/catalogue_parts.hpp"

#include <algorithm>
#include <utility>

namespace spm::stability {

double press_depth(double force) noexcept {
  return force * (1 / servo::arm_stiffness + 1 / servo::grip_stiffness);
}

double runway(double speed) noexcept {
  // The arm needs 82 ms and half of the target's way to reach its speed. Above 0.5 m/s the target
  // would stop before the tool arrives: a longer way lets the arm swing up to it.
  return 2e-3 + 45e-3 * speed + std::max(0.0, speed - 0.5) * 66e-3;
}

Vector3 pressed_target(const Press& press) noexcept {
  return press.place - press_depth(press.force) * press.normal;
}

StabilityCase press_case(std::string theme, std::string name, std::string title, test::Shape shape,
                         const Press& press) {
  StabilityCase made;
  made.theme = std::move(theme);
  made.name = std::move(name);
  made.title = std::move(title);
  made.shape = std::move(shape);
  made.normal = press.normal;
  made.start = press.place + runway(press.speed) * press.normal;
  made.hand = {{pressed_target(press), press.speed, press.rest}};
  made.seconds = script_seconds(made);
  made.seeds = 5;
  return made;
}

double script_seconds(const StabilityCase& tried) noexcept {
  double seconds = 0;
  Vector3 from = tried.start;
  for (const HandLeg& leg : tried.hand) {
    seconds += (leg.to - from).norm() / leg.speed + leg.rest;
    from = leg.to;
  }
  return seconds;
}

}  // namespace spm::stability
