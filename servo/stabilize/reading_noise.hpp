// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <cstddef>

#include "common/base/vector.hpp"

namespace spm {

/// How noisy the readings of a position are, estimated from the readings alone: by the mean square
/// of their fourth differences. The motion of a hand has hardly any (a swing of 1 mm at 30 Hz and 1
/// kHz leaves 1 um), while independent errors have seventy times their own mean square. Steps of an
/// encoder that moves count as noise.
class ReadingNoise {
 public:
  /// Takes the next tick's position, m. A position that is not finite starts again.
  void take(const Vector3& position) noexcept;

  /// The encoder step, m, whose error is as large as the noise: the square root of twelve times its
  /// mean square, of the worst axis. 0 before five positions came.
  [[nodiscard]] double as_step() const noexcept;

  /// Forgets all.
  void reset() noexcept {
    newest_ = count_ = 0;
    square_.setZero();
  }

 private:
  static constexpr std::size_t kept = 5;  ///< readings in a fourth difference
  std::array<Vector3, kept> last_{};      ///< a ring buffer
  std::size_t newest_ = 0, count_ = 0;
  Vector3 square_ = Vector3::Zero();  ///< m2, mean square of the error, for each axis
};

}  // namespace spm
