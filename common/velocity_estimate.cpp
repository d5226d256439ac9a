// SPDX-License-Identifier: Apache-2.0
#include "common/velocity_estimate.hpp"

#include <algorithm>
#include <cmath>

namespace spm {

double VelocityEstimate::slope(int axis) const noexcept {
  double slope = 0;
  for (std::size_t ticks = 1; ticks < count_; ++ticks) {
    const double tried = (ago(0, axis) - ago(ticks, axis)) / static_cast<double>(ticks);
    for (std::size_t k = 1; k < ticks; ++k) {
      const double line = ago(0, axis) - tried * static_cast<double>(k);
      if (std::abs(line - ago(k, axis)) > step_) return slope;
    }
    slope = tried;
  }
  return slope;
}

Vector3 VelocityEstimate::next(const Vector3& position) noexcept {
  if (!position.allFinite()) {
    reset();
    return Vector3::Zero();
  }
  newest_ = (newest_ + 1) % most_ticks;
  last_[newest_] = position;
  count_ = std::min(count_ + 1, most_ticks);
  return Vector3(slope(0), slope(1), slope(2)) / tick_;
}

}  // namespace spm
