// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <Eigen/Core>
#include <algorithm>
#include <array>
#include <cstdint>

#include "common/base/wrench.hpp"

namespace spm {

using Matrix6 = Eigen::Matrix<double, 6, 6>;
using Vector6 = Eigen::Matrix<double, 6, 1>;

/// The sum over contacts: the potential of penalty springs, its gradient and its curvature. Force
/// first, then torque, about one point, in one frame.
struct ContactSum {
  Vector6 wrench = Vector6::Zero();     ///< N, N m: minus the gradient of the energy
  Matrix6 stiffness = Matrix6::Zero();  ///< N/m, N, N m; positive semidefinite
  double energy = 0;                    ///< J
  double deepest = 0;                   ///< m, 0 or more
  std::uint64_t contacts = 0;

  /// Adds a spring of stiffness `spring` (N/m), compressed by `depth` (m) along the unit `normal`.
  /// `arm` (m) is its position relative to the point that torques are about. The energy is half the
  /// stiffness times `square` (m2), and `share` of the spring is in contact.
  void add(double spring, double depth, double square, double share, const Vector3& normal,
           const Vector3& arm) noexcept {
    // Element by element: a vector assembled from parts would stall the processor.
    const double x = normal[0], y = normal[1], z = normal[2];
    const std::array<double, 6> along{
        x, y, z, arm[1] * z - arm[2] * y, arm[2] * x - arm[0] * z, arm[0] * y - arm[1] * x};
    const double force = spring * depth;
    for (int row = 0; row < 6; ++row) wrench[row] += force * along[row];
    // The lower half only; ObjectContact mirrors it once per tick. Eigen's own update would be a
    // call.
    for (int column = 0; column < 6; ++column) {
      const double by = spring * share * along[column];
      for (int row = column; row < 6; ++row) stiffness(row, column) += by * along[row];
    }
    energy += spring * square / 2;
    deepest = std::max(deepest, depth);
    ++contacts;
  }
  [[nodiscard]] Wrench forces() const noexcept { return {wrench.head<3>(), wrench.tail<3>()}; }
};

}  // namespace spm
