// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <random>

#include "common/base/random.hpp"

namespace spm::test {

/// Random numbers that are the same with every standard library (Mersenne twister).
class RandomTwister {
 public:
  explicit RandomTwister(std::uint64_t seed) : bits_(seed) {}
  [[nodiscard]] std::uint64_t bits() { return bits_(); }
  /// Uniform in [0, 1).
  [[nodiscard]] double unit() { return unit_of_bits(bits_()); }
  [[nodiscard]] double between(double low, double high) { return low + (high - low) * unit(); }
  /// Each coordinate between minus `most` and `most`.
  [[nodiscard]] Vector3 vector(double most) {
    return most * Vector3(between(-1, 1), between(-1, 1), between(-1, 1));
  }
  [[nodiscard]] Vector3 in_box(const Vector3& low, const Vector3& high) {
    const double x = unit(), y = unit(), z = unit();
    return low + Vector3(x, y, z).cwiseProduct(high - low);
  }
  [[nodiscard]] Vector3 direction() {
    while (true) {
      const Vector3 v = in_box({-1, -1, -1}, {1, 1, 1});
      if (v.squaredNorm() <= 1 && v.squaredNorm() > 1e-6) return v.normalized();
    }
  }

 private:
  std::mt19937_64 bits_;
};

}  // namespace spm::test
