// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <Eigen/Core>
#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <cstring>

#include "common/base/across.hpp"
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
    const double x = normal[0], y = normal[1], z = normal[2];
    const double turn_x = arm[1] * z - arm[2] * y, turn_y = arm[2] * x - arm[0] * z,
                 turn_z = arm[0] * y - arm[1] * x;
    // Two rows at a time. Eigen's own update would be a call.
    using Two = double __attribute__((vector_size(16)));
    const std::array<Two, 3> along{Two{x, y}, Two{z, turn_x}, Two{turn_y, turn_z}};
    const auto add = [](double* to, const Two& what) {
      Two sum;
      std::memcpy(&sum, to, sizeof sum);
      sum += what;
      std::memcpy(to, &sum, sizeof sum);
    };
    const double force = spring * depth;
    for (std::size_t k = 0; k < 3; ++k) add(wrench.data() + 2 * k, force * along[k]);
    // The lower half only; ObjectContact mirrors it once per tick. What else is in its pairs of
    // rows does not count.
    for (std::size_t column = 0; column < 6; ++column) {
      const Two by = spring * share * along[column / 2][column % 2] * Two{1, 1};
      for (std::size_t k = column / 2; k < 3; ++k) {
        add(stiffness.data() + 6 * column + 2 * k, by * along[k]);
      }
    }
    energy += spring * square / 2;
    deepest = std::max(deepest, depth);
    ++contacts;
  }
  /// Adds a spring of stiffness `spring` (N/m) that acts along the surface alone, pulled out by
  /// `pull` (m) against its force, with an energy of its own (J). One that gives way pulls with a
  /// force that no longer grows: it is stiff across its pull alone.
  void add_along(double spring, const Vector3& pull, const Vector3& normal, const Vector3& arm,
                 double own_energy, bool gives_way) noexcept {
    const Vector3 force = spring * pull, torque = arm.cross(force);
    for (int row = 0; row < 3; ++row) {
      wrench[row] += force[row];
      wrench[3 + row] += torque[row];
    }
    const Vector3 first = gives_way ? pull.normalized() : across(normal);
    for (int k = gives_way ? 1 : 0; k < 2; ++k) {
      const Vector3 way = k == 0 ? first : Vector3(normal.cross(first));
      const Vector3 turn = arm.cross(way);
      const std::array<double, 6> along{way[0], way[1], way[2], turn[0], turn[1], turn[2]};
      for (int column = 0; column < 6; ++column) {
        const double by = spring * along[static_cast<std::size_t>(column)];
        for (int row = column; row < 6; ++row) {
          stiffness(row, column) += by * along[static_cast<std::size_t>(row)];
        }
      }
    }
    energy += own_energy;
  }
  [[nodiscard]] Wrench forces() const noexcept { return {wrench.head<3>(), wrench.tail<3>()}; }
};

}  // namespace spm
