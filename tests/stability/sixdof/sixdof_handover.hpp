// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include "tests/stability/laboratory/laboratory.hpp"
#include "tests/stability/sixdof/sixdof_scene.hpp"

namespace spm::stability {

/// What was found when one hand handed an object to another.
struct HandoverRun {
  double brought = 0;  ///< m, how far the first hand pushed the object to the second
  double taken = 0;    ///< m, how far the second pushed it back after the first had left
  double held = 0;     ///< N, of the second hand while both press the object, mean
  double met = 0;      ///< N, of the first hand while its tool presses the second's, mean
  double differs = 0;  ///< N, how far both hands' forces differ meanwhile, mean
  double ripple = 0;   ///< N RMS, the worst of both hands while they press, and while one is alone
  double deepest = 0;  ///< m, of a drawn tool in the exact object
  double overlap = 0;  ///< m, the most that the drawn tools lie in one another, along their axis
  double turned = 0;   ///< rad, the most that the object turned
};

/// Two devices of a profile, each in a hand with a flat tool of its own (`[[tool]]` of a scene),
/// and a free box between them that moves by what both do to it (SceneForce::reaction), in a medium
/// that brakes it. The first hand pushes the box against the second's tool, both press, the first
/// leaves, the second pushes the box back; then the first comes round from behind and pushes the
/// second's tool with its own. All that a little beside the middle, so that the box turns. The
/// case is handed_case().
[[nodiscard]] HandoverRun hand_over(const SixdofCase& tried, const SixdofScene& scene,
                                    const RunSettings& settings, const Contender& contender);

/// Judges it by the thresholds of every other case: ripple; what is pressed is held; no tool goes
/// through the object or the other tool.
[[nodiscard]] Verdict judge_handover(const SixdofCase& tried, const HandoverRun& run);

}  // namespace spm::stability
