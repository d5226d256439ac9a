// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <limits>

#include "common/base/random.hpp"
#include "tests/stability/sixdof/sixdof_contestant.hpp"

namespace spm::stability {

/// A run of one case, and what was found.
struct SixdofRun {
  Verdict verdict;
  Trace trace;  ///< of the tool's origin; work is of force and torque
  Trace
      turning;  ///< the same of the turn: radians and torques as lengths and forces at sixdof_lever
  Creep crept;  ///< the farthest from where the drawn tool lay when the case's creep began
};

/// Offset of a run between encoder steps, in steps, so that no run starts on a step by chance.
[[nodiscard]] Vector3 offset_of(Random& random);

/// Runs a case of one hand tick by tick. The seed moves it all by up to half an encoder step, and
/// turns it so.
[[nodiscard]] SixdofRun run_sixdof_case(const SixdofCase& tried, const SixdofScene& scene,
                                        const RunSettings& settings, const Contender& contender);

/// Judges a run by the thresholds of three degrees of freedom: force and torque, each of which must
/// pass. `deepest` (m): of the drawn tool in the exact objects, the case's penetration. A pop is
/// judged with the weight as part of what presses.
[[nodiscard]] Verdict judge_sixdof(const SixdofCase& tried, const RunSettings& settings,
                                   const SixdofRun& run, double deepest);

/// All seeds of a case, from the settings' on, or `max_seeds` of them.
[[nodiscard]] CaseVerdict sixdof_verdict(const SixdofCase& tried, const SixdofScene& scene,
                                         const RunSettings& settings, const Contender& contender,
                                         int max_seeds = std::numeric_limits<int>::max());

/// The largest stiffness (N/m) at which a case is good with all of its seeds, or `max_seeds` of
/// them, by `stiffest`.
[[nodiscard]] double sixdof_border(const SixdofCase& tried, const SixdofScene& scene,
                                   const RunSettings& settings, const Contender& contender,
                                   double low, double high, double share,
                                   int max_seeds = std::numeric_limits<int>::max());

}  // namespace spm::stability
