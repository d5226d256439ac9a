// SPDX-License-Identifier: Apache-2.0
#include "common/sixdof/contact_step.hpp"

#include <Eigen/Cholesky>
#include <cmath>
#include <limits>

namespace spm {

namespace {

constexpr int most_iterations = 16;
/// Steps in a row that may raise the energy.
constexpr int most_worse = 3;
/// A change of this size, m, is the end.
constexpr double settled = 1e-10;

/// The springs at a step: energy, its descent, and its curvature (lower half).
struct Springs {
  double energy = 0;
  Vector6 wrench = Vector6::Zero();
  Matrix6 stiffness = Matrix6::Zero();
};

Springs springs_at(std::span<const NearContact> contacts, const Vector6& step) noexcept {
  std::array<double, 6> by{}, wrench{};
  for (std::size_t k = 0; k < 6; ++k) by[k] = step[static_cast<Eigen::Index>(k)];
  std::array<std::array<double, 6>, 6> stiffness{};
  double energy = 0;
  for (const NearContact& contact : contacts) {
    std::array<double, 6> along;
    auto distance = static_cast<double>(contact.distance);
    for (std::size_t k = 0; k < 6; ++k) {
      along[k] = static_cast<double>(contact.along[k]);
      distance += along[k] * by[k];
    }
    if (!(distance < 0)) continue;
    const auto spring = static_cast<double>(contact.spring);
    energy += spring / 2 * distance * distance;
    for (std::size_t row = 0; row < 6; ++row) {
      wrench[row] -= spring * distance * along[row];
      for (std::size_t column = 0; column <= row; ++column) {
        stiffness[row][column] += spring * along[row] * along[column];
      }
    }
  }
  Springs made;
  made.energy = energy;
  for (Eigen::Index row = 0; row < 6; ++row) {
    made.wrench[row] = wrench[static_cast<std::size_t>(row)];
    for (Eigen::Index column = 0; column <= row; ++column) {
      made.stiffness(row, column) =
          stiffness[static_cast<std::size_t>(row)][static_cast<std::size_t>(column)];
    }
  }
  return made;
}

}  // namespace

ContactSum pressed_now(std::span<const NearContact> contacts) noexcept {
  const Springs springs = springs_at(contacts, Vector6::Zero());
  ContactSum sum;
  sum.wrench = springs.wrench;
  sum.stiffness = springs.stiffness.selfadjointView<Eigen::Lower>();
  sum.energy = springs.energy;
  return sum;
}

Vector6 contact_step(const Vector6& wrench, const Matrix6& stiffness,
                     std::span<const NearContact> contacts, double longest, double lever) noexcept {
  Vector6 best = Vector6::Zero(), step = best, from = best, way = best;
  double least = std::numeric_limits<double>::infinity();
  int worse = 0;
  for (int iteration = 0; iteration < most_iterations; ++iteration) {
    const Springs springs = springs_at(contacts, step);
    const Vector6 yielded = stiffness * step;
    const double energy = springs.energy - wrench.dot(step) + step.dot(yielded) / 2;
    if (energy < least) {
      least = energy;
      best = step;
      worse = 0;
    } else if (++worse > most_worse) {
      // Among the same springs again and again: a part of the way.
      way = (from - best) / 2;
      from = step = best + way;
      continue;
    }
    // Also from where the energy is more: there are springs of which the step before did not know.
    const Matrix6 whole = stiffness + Matrix6(springs.stiffness.selfadjointView<Eigen::Lower>());
    way = whole.ldlt().solve(wrench - yielded + springs.wrench);
    const double length = way.head<3>().norm() + lever * way.tail<3>().norm();
    if (!(length > settled)) break;
    if (length > longest) way *= longest / length;
    from = step = step + way;
  }
  return best;
}

}  // namespace spm
