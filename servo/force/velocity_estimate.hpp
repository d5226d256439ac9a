// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>

#include "common/contact/stabilization_settings.hpp"
#include "common/base/vector.hpp"

namespace spm {

/// The velocity of a position that an encoder counts in steps, from the last ticks: of all windows
/// that end now the longest through which a straight line meets every position within the step; its
/// slope is the velocity. Slow motion is so told from many ticks, without the noise of one step a
/// tick, and fast motion from few, without lag (first-order adaptive windowing, Janabi-Sharifi,
/// Hayward and Chen 2000, with the line through the window's ends).
class VelocityEstimate {
 public:
  static constexpr std::size_t most_ticks = 32;

  /// `step`: how far a position may be off, m, 0 or more; `tick` in s, above 0.
  VelocityEstimate(double step, double tick, VelocityBy by = VelocityBy::estimate) noexcept
      : step_(step), tick_(tick), longest_(by == VelocityBy::difference ? 2 : most_ticks) {}

  /// Takes the next tick's position, m, and gives the velocity, m/s; axis by axis. A position that
  /// is not finite starts anew and gives zero.
  [[nodiscard]] Vector3 next(const Vector3& position) noexcept;

  /// The two halves of it, for ticks in which nobody asks for the velocity.
  void take(const Vector3& position) noexcept;
  [[nodiscard]] Vector3 velocity() const noexcept { return beyond(0); }
  /// The same, but a window's way of up to so many steps (0 or more) counts for nothing, and for
  /// all that it is from twice as many on: for who would rather brake too little than answer the
  /// encoder.
  [[nodiscard]] Vector3 beyond(double steps) const noexcept;

  /// From now on positions may be off by so much, m.
  void allow(double step) noexcept { step_ = step; }

  /// Forgets all: after a jump that is no motion.
  void reset() noexcept { count_ = 0; }

 private:
  double step_, tick_;
  std::size_t longest_;                     ///< positions that are looked at
  std::array<Vector3, most_ticks> last_{};  ///< a ring
  std::size_t newest_ = 0, count_ = 0;

  /// An axis of the position so many ticks ago.
  [[nodiscard]] double ago(std::size_t ticks, int axis) const noexcept {
    return last_[(newest_ + most_ticks - ticks) % most_ticks][axis];
  }
  [[nodiscard]] bool meets_all(double slope, std::size_t ticks, int axis) const noexcept;
  [[nodiscard]] double slope(int axis, double but) const noexcept;
};

}  // namespace spm
