// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>

#include "common/base/vector.hpp"

namespace spm::servo {

/// What a runaway is recognised by; figures of the device.
struct RunawaySettings {
  double moving_mass = 0;   ///< kg at the tool; 0: the device gives no force, nothing is watched
  double encoder_step = 0;  ///< m
  double tick = 1e-3;       ///< s
};

/// Recognises a device that pushes the wrong way, because a motor or an encoder counts backwards:
/// what ought to hold the hand back draws it in, ever faster, until its strength ends.
///
/// A force along u changes the motion of what it acts on along u, whatever mechanism lies between:
/// u . M^-1 u > 0 for every inertia M. So the hand's way against the force F that was sent, s,
/// obeys m s'' = -F + (what the person does), m being the moving mass. Where a sign is wrong it
/// obeys m s'' = r F, with r = m / (m + the hand's mass). To look the same, a person would have to
/// push at every moment with (1 + r) times the force that holds her back, while that grows
/// manifold, and before she can have felt it. People move by plans of a tenth of a second and more:
/// the way of a hand that presses or passes through is no solution of m s'' = r F. The guard asks
/// whether the hand's way is one:
///
/// - The force has grown, from a sixteenth of what it is now, and is half of the cap or more.
/// - Over that time, and as long before, s = c0 + c1 t + c2 t^2 / 2 + r D / m, where D is the force
///   integrated twice. What is left is at most half an encoder's step, or a tenth of what r
///   explains beyond the other three.
/// - r is positive beyond six standard deviations of the encoder's rounding; at least 0.1 (a hand
///   of nine times the moving mass: with a heavier one the device is no faster than a press); and
///   at most 1.5, since the mass is a figure of the kind of device and not of the piece.
/// - m c2, a constant force beside it, is at most a quarter of r F: the force moves the hand, not
///   the person.
///
/// None of these is an amount of work, because a person's work has no bound that a wrong sign's has
/// not: seen from the command, the hand moves against the force in both. So pushes, moving objects,
/// springs, magnets and thick air of applications pass, as long as the device obeys them. The wrong
/// sign of an axis that the force does not use is seen once it does. No call allocates or throws.
class RunawayGuard {
 public:
  explicit RunawayGuard(const RunawaySettings& settings) noexcept : settings_(settings) {}

  /// Takes where the hand is, m, in a tick (its index on the grid). True if it runs away by the
  /// forces that were sent until then. `cap`: N, the largest that may be sent.
  [[nodiscard]] bool runs_away(const Vector3& hand, std::uint64_t tick, double cap) noexcept;
  /// The force that is sent in that tick, N.
  void sent(const Vector3& force) noexcept;
  /// The hand was away: what came before is another story.
  void forget() noexcept { count_ = 0; }

 private:
  /// A quarter of a second at the usual rate; a power of two.
  static constexpr std::size_t kept = 256;
  static constexpr std::size_t fewest =
      8;  ///< ticks of growth, for less the encoder says too little

  struct Tick {
    std::uint64_t number = 0;
    Vector3 hand = Vector3::Zero();
    Vector3 force = Vector3::Zero();
  };
  /// Of the ticks that are kept, 0 the newest.
  [[nodiscard]] const Tick& before(std::size_t ticks) const noexcept {
    return ticks_[(last_ - ticks) % kept];
  }
  [[nodiscard]] std::size_t growth(const Vector3& along, double least) const noexcept;
  [[nodiscard]] bool follows(const Vector3& along, double force, std::size_t ticks) const noexcept;

  RunawaySettings settings_;
  std::array<Tick, kept> ticks_;
  std::size_t last_ = 0, count_ = 0;
};

}  // namespace spm::servo
