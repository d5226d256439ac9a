// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <Eigen/Core>
#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <cstring>

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
    press(spring, depth, square, share, line(normal, arm));
  }
  /// The same of a spring all of which is in contact; `along`: its normal, and arm x normal, m.
  void add(double spring, double depth, const std::array<float, 6>& along) noexcept {
    press(spring, depth, depth * depth, 1,
          {Two{double{along[0]}, double{along[1]}}, Two{double{along[2]}, double{along[3]}},
           Two{double{along[4]}, double{along[5]}}});
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
    // As stiff all ways round, less what it would be along the normal, and along its pull.
    stiffen_all_ways(spring, arm);
    stiffen(-spring, line(normal, arm));
    if (gives_way) stiffen(-spring, line(pull.normalized(), arm));
    energy += own_energy;
  }
  [[nodiscard]] Wrench forces() const noexcept { return {wrench.head<3>(), wrench.tail<3>()}; }

 private:
  // Two rows at a time. Eigen's own update would be a call.
  using Two = double __attribute__((vector_size(16)));
  /// A unit vector, and its moment about the point that torques are about.
  using Line = std::array<Two, 3>;

  [[nodiscard]] static Line line(const Vector3& way, const Vector3& arm) noexcept {
    const double x = way[0], y = way[1], z = way[2];
    const double turn_x = arm[1] * z - arm[2] * y, turn_y = arm[2] * x - arm[0] * z,
                 turn_z = arm[0] * y - arm[1] * x;
    return {Two{x, y}, Two{z, turn_x}, Two{turn_y, turn_z}};
  }
  static void add(double* to, const Two& what) noexcept {
    Two sum;
    std::memcpy(&sum, to, sizeof sum);
    sum += what;
    std::memcpy(to, &sum, sizeof sum);
  }
  void press(double spring, double depth, double square, double share, const Line& along) noexcept {
    const double force = spring * depth;
    for (std::size_t k = 0; k < 3; ++k) add(wrench.data() + 2 * k, force * along[k]);
    stiffen(spring * share, along);
    energy += spring * square / 2;
    deepest = std::max(deepest, depth);
    ++contacts;
  }
  /// Adds a stiffness, N/m, along a line. The lower half only; ObjectContact mirrors it once per
  /// tick. What else is in its pairs of rows does not count.
  void stiffen(double by, const Line& along) noexcept {
    for (std::size_t column = 0; column < 6; ++column) {
      const Two part = by * along[column / 2][column % 2] * Two{1, 1};
      for (std::size_t k = column / 2; k < 3; ++k) {
        add(stiffness.data() + 6 * column + 2 * k, part * along[k]);
      }
    }
  }
  /// The same along all three lines that are across one another. The lower half only.
  void stiffen_all_ways(double by, const Vector3& arm) noexcept {
    const double x = arm[0], y = arm[1], z = arm[2];
    const double by_x = by * x, by_y = by * y, by_z = by * z;
    double* const to = stiffness.data();
    to[0] += by;
    to[4] += by_z;
    to[5] -= by_y;
    to[7] += by;
    to[9] -= by_z;
    to[11] += by_x;
    to[14] += by;
    to[15] += by_y;
    to[16] -= by_x;
    to[21] += by_y * y + by_z * z;
    to[22] -= by_x * y;
    to[23] -= by_x * z;
    to[28] += by_x * x + by_z * z;
    to[29] -= by_y * z;
    to[35] += by_x * x + by_y * y;
  }
};

}  // namespace spm
