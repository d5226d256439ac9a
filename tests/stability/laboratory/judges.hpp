// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <string>

#include "tests/stability/laboratory/stability_trace.hpp"
#include "tests/stability/objects/stability_case.hpp"

namespace spm::stability {

/// Properties of the device and the force law that the thresholds and bounds need.
struct JudgedLoop {
  double stiffness = 1000;    ///< N/m, that the hand feels
  double delay = 1;           ///< ticks
  double lag = 0;             ///< s, of the actuator
  double encoder_step = 0;    ///< m
  double force_cap = 0;       ///< N; 0: none
  double hand_stiffness = 0;  ///< N/m, at rest, from the hand's target to the tool; 0: no hand
  double friction = 0;        ///< N, of the device; it may carry a part of the hand's press
};

/// The figures of a run.
struct Findings {
  double ripple_n = 0;     ///< N RMS, of the commanded force in hold, moving mean removed
  double ripple_m = 0;     ///< m peak to peak, of the true position in hold, moving mean removed
  double generated_j = 0;  ///< J, largest net work on the hand, without that of moving surfaces
  double generated_bound_j = 0;  ///< X <= 2 [K (1/2 + d + lag/T)(v_max T)^2 + F_max D]
  double penetration_m =
      0;                 ///< m, in contact: largest distance below the first touch, along `normal`
  double settled_s = 0;  ///< s, after which the tool stays at rest; infinite where never
  double held_n = 0;     ///< N, mean force along the normal in hold
  double pressed_n = 0;  ///< N, the hand's press if the surface held it; 0: it does not press
  bool popped = false;   ///< the held force along the normal fell below 0.3 of the hand's, or
                         ///< the surface was never felt
};

/// The judgement of the figures. Energy is judged separately from good and bad: every sampled force
/// leaks some energy in a tick, and a thin plate can be lost without any energy being generated.
/// Energy decides the verdict only for a tool that is carried, because nothing else can be judged
/// there: good within its bound, bad above twice the bound.
struct Verdict {
  bool good = true;           ///< ripple passes, no pop, settled where that is judged
  bool bad = false;           ///< fails clearly; a verdict neither good nor bad is "between"
  bool within_energy = true;  ///< generated no more than its bound, where that is judged
  std::string reason;         ///< why it is not good, with figures; empty where good
  Findings findings;
};

/// Thresholds (../shared/notes/stability-prototype.md, measured there before any run of ours).
inline constexpr double good_ripple = 0.03;    ///< N RMS
inline constexpr double bad_ripple = 0.1;      ///< N RMS
inline constexpr double bad_motion_steps = 3;  ///< encoder steps, peak to peak; at least
inline constexpr double bad_motion = 100e-6;   ///< m
inline constexpr double pop_share = 0.3;       ///< of the hand's force along the normal
inline constexpr double hold_seconds = 0.7;    ///< s, the end of a run that is looked at
inline constexpr double mean_seconds = 0.1;    ///< s, of the moving mean, centred

/// Finds every figure of a run, whatever the case wants judged.
[[nodiscard]] Findings find(const StabilityCase& tried, const JudgedLoop& loop, const Trace& trace);

/// Judges a run of at least hold_seconds and mean_seconds; a shorter one has no ripple.
[[nodiscard]] Verdict judge(const StabilityCase& tried, const JudgedLoop& loop, const Trace& trace);

/// Peak energy in the last quarter of a run over the peak in the second quarter. Above 1 the motion
/// grows; 0 where the tool rests in the last quarter, infinite where it rests only in the second.
/// An oscillation's peak kinetic energy is all of its energy, and the mass cancels. This ratio
/// decides borders of linear loops; the absolute thresholds decide verdicts only.
[[nodiscard]] double envelope_ratio(const Trace& trace);

}  // namespace spm::stability
