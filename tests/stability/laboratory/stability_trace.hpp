// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <vector>

#include "common/base/vector.hpp"

namespace spm::stability {

/// One tick of a closed loop, as the laboratory sees it, including what the servo cannot know.
struct TraceTick {
  double time = 0;                       ///< s, at the tick's begin
  Vector3 target = Vector3::Zero();      ///< m, where the hand wants the tool
  Vector3 position = Vector3::Zero();    ///< m, true, at the tick's begin
  Vector3 velocity = Vector3::Zero();    ///< m/s, true
  Vector3 measured = Vector3::Zero();    ///< m, as the encoders read it
  Vector3 commanded = Vector3::Zero();   ///< N, the force law's answer to `measured`
  Vector3 hand_force = Vector3::Zero();  ///< N, of the hand on the tool, mean over the tick
  Vector3 surface = Vector3::Zero();     ///< m, how far the object has been moved since the start
  double depth = 0;                      ///< m, the depth that the force law used
  double work = 0;          ///< J, of the actuator on the tool over the tick, by true motion
  double surface_work = 0;  ///< J, that the object's own motion put in: minus force times its way
  bool contact = false;
};

/// A run of one case.
struct Trace {
  double period = 1e-3;  ///< s
  std::vector<TraceTick> ticks;
};

}  // namespace spm::stability
