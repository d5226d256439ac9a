// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <vector>

#include "tests/stability/theory/sampled_loop.hpp"

namespace spm::stability {

/// The loop that an adversary attacks: the plant in the grip of a hand that takes the tool wherever
/// it wants, and a wall that acts on the readings.
struct AdversaryBoard {
  SampledLoop loop;         ///< its filter, lag and hand are not used; the delay is in whole ticks
  double friction = 0;      ///< N, Coulomb
  double encoder_step = 0;  ///< m; 0: none
};

/// A hand's closed motion in one direction: one position per tick, m below the wall's surface.
/// After the last the first comes again. At least one.
using ClosedMotion = std::vector<double>;

/// Energy, J, that the hand draws from device and wall in one round of a motion, once the motion
/// repeats. If it is above 0, the wall is not passive. Measured on servo::SimPlant. The wall pushes
/// with K depth + B times the difference of the last two readings over a tick, never capped.
[[nodiscard]] double energy_drawn(const AdversaryBoard& board, const ClosedMotion& motion);

/// Moves to and fro by `amplitude` (m) each tick about a depth: the worst case for the hold.
[[nodiscard]] ClosedMotion alternating_motion(double amplitude, double depth);

/// Moves to and fro by `share` of an encoder step about one edge between two counts, edge number
/// `edge`.
[[nodiscard]] ClosedMotion edge_motion(double encoder_step, double share, int edge);

/// A cosine with a period of so many ticks: with slow ones the delay yields the most energy.
[[nodiscard]] ClosedMotion slow_motion(double amplitude, int ticks);

/// The smallest stiffness (N/m) between `low` and `high` at which any of the motions draws energy,
/// to a share of 1e-7. None may draw energy at `low` and some must at `high`; 0 where that is not
/// so.
[[nodiscard]] double drawn_border(AdversaryBoard board, const std::vector<ClosedMotion>& motions,
                                  double low, double high);

}  // namespace spm::stability
