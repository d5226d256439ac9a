// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <algorithm>
#include <cstdint>

#include "servo/stabilize/reading_noise.hpp"
#include "servo/stabilize/velocity_estimate.hpp"

namespace spm {

/// A displacement of up to this many encoder steps gives no velocity for damping. The same holds
/// for steps of the readings' own noise. Otherwise a tool that swings between two steps would be
/// braked with knocks that keep it swinging.
inline constexpr double doubted_steps = 1;

/// The velocity of a position, as damping uses it. It is estimated over a window as long as the
/// encoder's step or the readings' own noise require, and is more likely too small than too large.
class BrakingVelocity {
 public:
  /// `encoder_step`: m, 0 or more; `tick` in s, above 0.
  BrakingVelocity(double encoder_step, double tick,
                  VelocityMethod by = VelocityMethod::estimate) noexcept
      : encoder_step_(encoder_step), estimate_(encoder_step, tick, by) {}

  /// Takes a position, m, `ticks` after the last one.
  void take(const Vector3& position, std::uint64_t ticks = 1) noexcept {
    noise_.take(position);
    estimate_.allow(std::max(encoder_step_, noise_.as_step()));
    estimate_.take(position, ticks);
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
