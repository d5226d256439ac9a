// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cmath>
#include <numbers>

namespace spm {

/// Half-width of the filter's window in sigmas; 1.1 % of a Gaussian's weight lies beyond it.
inline constexpr double gaussian_cutoff = 3;

/// The kernel G_sigma of eq. 16 at an offset (eta, omega) along a support plane, 1/m2. Its integral
/// over the plane is 1. Lengths in metres, sigma above 0.
[[nodiscard]] inline double gaussian_kernel(double sigma, double eta, double omega) noexcept {
  const double variance = sigma * sigma;
  return std::exp(-(eta * eta + omega * omega) / (2 * variance)) /
         (2 * std::numbers::pi * variance);
}

/// D'_SP of eq. 16 at one place of a distance map: D_SP * G_sigma as a sum over the samples around
/// it. The sum is divided by the weight of the samples that were added. So samples that are left
/// out, beyond a silhouette or of another layer, do not count. Value is a distance D_SP, or the
/// surface's point of eq. 4 where the position that the distance is measured from must be filtered
/// with it.
template <class Value>
class GaussianWindow {
 public:
  /// `sigma` in metres, above 0; `zero` is what the sum starts from.
  GaussianWindow(double sigma, const Value& zero) noexcept : sigma_(sigma), sum_(zero) {}

  /// Adds a sample at the offset (eta, omega), metres. It represents `area`, m2, of the plane: the
  /// squared spacing on a map's lattice.
  void add(double eta, double omega, double area, const Value& value) noexcept {
    const double weight = gaussian_kernel(sigma_, eta, omega) * area;
    sum_ += weight * value;
    weight_ += weight;
  }

  /// The part of the kernel's weight that was covered by samples: 1 where the whole plane was
  /// covered.
  [[nodiscard]] double weight() const noexcept { return weight_; }

  /// The filtered value; `weight` must be above 0.
  [[nodiscard]] Value value() const noexcept { return sum_ / weight_; }

 private:
  double sigma_;
  double weight_ = 0;
  Value sum_;
};

}  // namespace spm
