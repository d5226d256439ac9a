// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <cstddef>

#include "common/base/vector.hpp"

namespace spm {

/// How noisy a position's readings are, from the readings alone: the mean square of their fourth
/// differences, which a hand's motion hardly has (a swing of 1 mm at 30 Hz and 1 kHz leaves 1 um)
/// and independent errors have seventy times over. Steps of an encoder that is moved count as such.
class ReadingNoise {
 public:
  /// Takes the next tick's position, m; one that is not finite starts anew.
  void take(const Vector3& position) noexcept;

  /// The encoder step, m, whose error has the noise's size: the square root of twelve times its
  /// mean square, of the worst axis; 0 before five positions came.
  [[nodiscard]] double as_step() const noexcept;

  /// Forgets all.
  void reset() noexcept {
    newest_ = count_ = 0;
    square_.setZero();
  }

 private:
  static constexpr std::size_t kept = 5;  ///< readings that a fourth difference is of
  std::array<Vector3, kept> last_{};      ///< a ring
  std::size_t newest_ = 0, count_ = 0;
  Vector3 square_ = Vector3::Zero();  ///< m2, of an error, axis by axis
};

}  // namespace spm
