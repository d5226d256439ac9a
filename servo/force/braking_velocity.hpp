// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <algorithm>

#include "servo/force/reading_noise.hpp"
#include "servo/force/velocity_estimate.hpp"

namespace spm {

/// A way of so many of the encoder's steps, or of the noise's that readings show, tells no velocity
/// to brake: a tool that swings between two steps would be braked with knocks that keep it
/// swinging.
inline constexpr double doubted_steps = 1;

/// The velocity of a position that is to be braked: told from as long a window as the encoder's
/// step or the readings' own noise ask for, and rather too small than the encoder's.
class BrakingVelocity {
 public:
  /// `encoder_step`: m, 0 or more; `tick` in s, above 0.
  BrakingVelocity(double encoder_step, double tick, VelocityBy by = VelocityBy::estimate) noexcept
      : encoder_step_(encoder_step), estimate_(encoder_step, tick, by) {}

  /// Takes the next tick's position, m.
  void take(const Vector3& position) noexcept {
    noise_.take(position);
    estimate_.allow(std::max(encoder_step_, noise_.as_step()));
    estimate_.take(position);
  }

  /// m/s
  [[nodiscard]] Vector3 now() const noexcept { return estimate_.beyond(doubted_steps); }

  /// Forgets all.
  void reset() noexcept {
    noise_.reset();
    estimate_.reset();
  }

 private:
  double encoder_step_;  ///< m
  ReadingNoise noise_;
  VelocityEstimate estimate_;
};

}  // namespace spm
