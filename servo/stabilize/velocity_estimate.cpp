// SPDX-License-Identifier: Apache-2.0
#include "servo/stabilize/velocity_estimate.hpp"

#include <algorithm>
#include <cmath>
#include <limits>

namespace spm {

namespace {

/// 1 / n for each number of ticks n.
constexpr auto inverses = [] {
  std::array<double, VelocityEstimate::max_ticks> table{};
  for (std::size_t ticks = 1; ticks < table.size(); ++ticks) {
    table[ticks] = 1.0 / static_cast<double>(ticks);
  }
  return table;
}();

}  // namespace

/// Whether the line of this slope (m a tick) through the newest position passes within a step of
/// all positions between it and the one `ticks` ago.
bool VelocityEstimate::meets_all(double slope, std::size_t ticks, int axis) const noexcept {
  for (std::size_t k = 1; k < ticks; ++k) {
    const double line = ago(0, axis) - slope * static_cast<double>(k);
    if (std::abs(line - ago(k, axis)) > step_) return false;
  }
  return true;
}

/// Each position allows a range of slopes, so that one test for each is enough. The exception is a
/// slope at the very end of the range that all of them allow, which rounding must not decide.
double VelocityEstimate::slope(int axis, double but) const noexcept {
  const double now = ago(0, axis);
  const double rounding = 1e-12 * (std::abs(now) + step_);
  double least = -std::numeric_limits<double>::infinity();
  double most = std::numeric_limits<double>::infinity();
  std::size_t longest = 0;
  for (std::size_t ticks = 1; ticks < count_; ++ticks) {
    const double way = now - ago(ticks, axis);
    const double tried = way * inverses[ticks];
    if (!(tried > least + rounding && tried < most - rounding)) {
      if (tried < least - rounding || tried > most + rounding) break;
      if (!meets_all(way / static_cast<double>(ticks), ticks, axis)) break;
    }
    longest = ticks;
    const double slack = step_ * inverses[ticks];
    least = std::max(least, tried - slack);
    most = std::min(most, tried + slack);
  }
  if (longest == 0) return 0;
  const double way = now - ago(longest, axis);
  // Nothing up to `but`, the full value from twice that on, without a jump between.
  const double counted = std::min(std::abs(way), 2 * std::max(0.0, std::abs(way) - but));
  return std::copysign(counted, way) / static_cast<double>(longest);
}

void VelocityEstimate::take(const Vector3& position, std::uint64_t ticks) noexcept {
  if (!position.allFinite() || ticks >= max_ticks) reset();
  if (!position.allFinite()) return;
  const Vector3 last = last_[newest_];
  for (std::uint64_t k = 1; count_ > 0 && k < ticks; ++k) {
    push(last + static_cast<double>(k) / static_cast<double>(ticks) * (position - last));
  }
  push(position);
}

void VelocityEstimate::push(const Vector3& position) noexcept {
  newest_ = (newest_ + 1) % max_ticks;
  last_[newest_] = position;
  count_ = std::min(count_ + 1, longest_);
}

Vector3 VelocityEstimate::beyond(double steps) const noexcept {
  const double but = steps * step_;
  return Vector3(slope(0, but), slope(1, but), slope(2, but)) / tick_;
}

Vector3 VelocityEstimate::next(const Vector3& position, std::uint64_t ticks) noexcept {
  take(position, ticks);
  return velocity();
}

}  // namespace spm
