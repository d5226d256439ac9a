// SPDX-License-Identifier: Apache-2.0
#include "servo/stabilize/reading_noise.hpp"

#include <cmath>

namespace spm {

namespace {

/// The mean square of the fourth differences, as a multiple of the mean square of independent
/// errors: 1 + 16 + 36 + 16 + 1.
constexpr double gain = 70;
/// The weight of the newest value in the mean, which therefore forgets within a quarter of a
/// second.
constexpr double share = 1.0 / 64;

}  // namespace

void ReadingNoise::take(const Vector3& position) noexcept {
  if (!position.allFinite()) return reset();
  newest_ = (newest_ + 1) % kept;
  last_[newest_] = position;
  if (count_ < kept && ++count_ < kept) return;
  const auto ago = [this](std::size_t ticks) -> const Vector3& {
    return last_[(newest_ + kept - ticks) % kept];
  };
  const Vector3 fourth = ago(0) + ago(4) - 4 * (ago(1) + ago(3)) + 6 * ago(2);
  square_ += share * (fourth.cwiseAbs2() / gain - square_);
}

double ReadingNoise::as_step() const noexcept { return std::sqrt(12 * square_.maxCoeff()); }

}  // namespace spm
