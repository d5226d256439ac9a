// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include "servo/devices/sim/hand_model.hpp"

namespace spm::stability {

/// A device against a wall that is always in contact, in one direction and without Coulomb
/// friction, encoder steps or force cap: all that is linear. SI units.
struct SampledLoop {
  double mass = 0.1;          ///< kg, of the tool; above 0
  double device_damping = 0;  ///< N s/m, of the device itself
  double stiffness = 1000;    ///< N/m, of the wall
  double damping = 0;         ///< N s/m, of the wall: times the difference of two readings over a
                              ///< tick, filtered where `filter` says so
  double filter = 0;          ///< Hz, of a first-order low pass on that velocity; 0: none
  double period = 1e-3;       ///< s, of a tick
  double delay_ticks = 0;     ///< 0 or more, whole or not
  double lag = 0;             ///< s, time constant of the actuator; 0: none
  servo::HandModel hand = servo::HandModel::none;  ///< the hand's target is at rest
};

/// Largest modulus of the eigenvalues of the loop's exact map from one tick to the next: below 1
/// the loop is asymptotically stable. Continuous parts are computed by the matrix exponential,
/// including the held force and its fractional delay. Criterion: stability. Source: any text on
/// sampled-data systems, such as Astrom and Wittenmark, Computer-Controlled Systems, 1997, ch. 3.
[[nodiscard]] double spectral_radius(const SampledLoop& loop);

/// The smallest stiffness (N/m), from `low` up, at which the spectral radius reaches 1. 0 where it
/// is already above 1 at `low`, infinite where it stays below 1 up to `high`. `loop.stiffness` is
/// not used. Accurate to a share of 1e-9.
[[nodiscard]] double border_stiffness(SampledLoop loop, double low = 1, double high = 1e6);

/// K < (b + B) / (T/2 + t_d). Criterion: stability, approximately, for a mass that is large beside
/// b T and delays of few ticks; on the unsafe side with filtered damping. Source: Gil, Sanchez,
/// Hulin, Preusche and Hirzinger, Stability boundary for haptic rendering: influence of damping and
/// delay, 2009.
[[nodiscard]] double approximate_border(const SampledLoop& loop) noexcept;

/// b > K T/2 + |B|, solved for K. Criterion: passivity for any hand, exact for a loop without
/// delay. Source: Colgate and Schenkel, Passivity of a class of sampled-data systems, 1994. 0 where
/// none.
[[nodiscard]] double passive_border(const SampledLoop& loop) noexcept;

/// K < b / (T (1/2 + d)), d whole ticks of delay, no virtual damping. Criterion: passivity for any
/// hand; approached by ever slower moves. Colgate and Schenkel's condition,
/// b > T/2 Re{(1 - e^(-jwT)) H} / (1 - cos wT), for H = K e^(-jwdT): the quotient is
/// K sin((2d + 1) wT/2) / sin(wT/2), largest at w = 0.
[[nodiscard]] double delayed_passive_border(const SampledLoop& loop) noexcept;

/// K <= min(2 b / T, 2 f_c / D). Criterion: passivity for any hand, no delay, no virtual damping.
/// `friction` f_c in N, Coulomb; `encoder_step` D in m, above 0. Source: Diolaiti, Niemeyer,
/// Barbagli and Salisbury, Stability of haptic rendering: discretization, quantization, time delay
/// and Coulomb effects, 2006; Abbott and Okamura, Effects of position quantization and sampling
/// rate on virtual-wall passivity, 2005.
[[nodiscard]] double quantised_passive_border(const SampledLoop& loop, double friction,
                                              double encoder_step) noexcept;

}  // namespace spm::stability
