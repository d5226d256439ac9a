// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include "tests/stability/laboratory/laboratory.hpp"

namespace spm::stability {

/// What was found when one hand handed an object to another.
struct HandoverRun {
  double brought = 0;      ///< m, how far the first hand pushed the object to the second
  double taken = 0;        ///< m, how far the second pushed it back after the first had left
  double ripple_both = 0;  ///< N RMS, the worse hand's, in the last 0.3 s in which both press
  double ripple_end = 0;   ///< N RMS, of the second, in the last 0.3 s
  double held = 0;         ///< N, of the second hand while both press, mean over that time
  double deepest = 0;      ///< m, of a drawn tool in the object, as its force law says
  double turned = 0;       ///< rad, the most that the object turned
};

/// Two devices of a profile, each in a hand with a flat tool, and a free box between them that
/// moves by what both do to it (SceneForce::reaction), in a medium that brakes it. The first hand
/// pushes the box against the second's tool, both press, the first leaves, the second pushes it
/// back. Both hands meet the box a little beside its middle, so that it turns. By the servo's
/// default method and stabilization.
[[nodiscard]] HandoverRun hand_over(const RunSettings& settings);

}  // namespace spm::stability
