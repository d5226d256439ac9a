// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>

#include "common/base/vector.hpp"
#include "common/contact/stabilization_settings.hpp"

namespace spm {

/// The velocity of a position that an encoder counts in steps, from the last ticks (first-order
/// adaptive windowing, Janabi-Sharifi, Hayward and Chen 2000, with the line through the window's
/// ends). Among all windows that end now it takes the longest one in which a straight line passes
/// within the step of every position; the slope of the line is the velocity. So slow motion is
/// estimated from many ticks, without the noise of one step a tick, and fast motion from few ticks,
/// without lag.
class VelocityEstimate {
 public:
  static constexpr std::size_t max_ticks = 32;

  /// `step`: largest error of a position, m, 0 or more; `tick` in s, above 0.
  VelocityEstimate(double step, double tick, VelocityMethod by = VelocityMethod::estimate) noexcept
      : step_(step), tick_(tick), longest_(by == VelocityMethod::difference ? 2 : max_ticks) {}

  /// Takes a position, m, `ticks` after the last one, and returns the velocity, m/s, axis by axis.
  /// A position that is not finite starts again and gives zero.
  [[nodiscard]] Vector3 next(const Vector3& position, std::uint64_t ticks = 1) noexcept;

  /// The two halves of `next`, for ticks in which nobody needs the velocity. Where ticks were
  /// skipped, the way between is taken for even.
  void take(const Vector3& position, std::uint64_t ticks = 1) noexcept;
  [[nodiscard]] Vector3 velocity() const noexcept { return beyond(0); }
  /// The same, but a displacement over the window of up to `steps` steps (0 or more) counts as
  /// none, and from twice that on it counts fully. For callers that prefer too little damping to an
  /// answer to encoder steps.
  [[nodiscard]] Vector3 beyond(double steps) const noexcept;

  /// Sets the largest error of positions from now on, m.
  void allow(double step) noexcept { step_ = step; }

  /// Forgets all state: after a jump that is no motion.
  void reset() noexcept { count_ = 0; }

 private:
  double step_, tick_;
  std::size_t longest_;                    ///< number of positions in use
  std::array<Vector3, max_ticks> last_{};  ///< a ring buffer
  std::size_t newest_ = 0, count_ = 0;

  /// One coordinate of the position that many ticks ago.
  [[nodiscard]] double ago(std::size_t ticks, int axis) const noexcept {
    return last_[(newest_ + max_ticks - ticks) % max_ticks][axis];
  }
  void push(const Vector3& position) noexcept;
  [[nodiscard]] bool meets_all(double slope, std::size_t ticks, int axis) const noexcept;
  [[nodiscard]] double slope(int axis, double but) const noexcept;
};

}  // namespace spm
