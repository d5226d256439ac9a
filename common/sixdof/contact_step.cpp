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

/// What the springs that touch at a step add to energy, wrench and stiffness (lower half).
ContactSum springs_at(std::span<const NearContact> contacts, const Vector6& step) noexcept {
  std::array<double, 6> by{};
  for (std::size_t k = 0; k < 6; ++k) by[k] = step[static_cast<Eigen::Index>(k)];
  ContactSum sum;
  for (const NearContact& contact : contacts) {
    auto distance = static_cast<double>(contact.distance);
    for (std::size_t k = 0; k < 6; ++k) distance += static_cast<double>(contact.along[k]) * by[k];
    if (distance < 0) sum.add(static_cast<double>(contact.spring), -distance, contact.along);
  }
  return sum;
}

}  // namespace

ContactSum pressed_now(std::span<const NearContact> contacts) noexcept {
  ContactSum sum = springs_at(contacts, Vector6::Zero());
  const Matrix6 whole = sum.stiffness.selfadjointView<Eigen::Lower>();
  sum.stiffness = whole;
  return sum;
}

Vector6 contact_step(const Vector6& wrench, const Matrix6& stiffness,
                     std::span<const NearContact> contacts, double longest, double lever) noexcept {
  Vector6 best = Vector6::Zero(), step = best, from = best, way = best;
  double least = std::numeric_limits<double>::infinity();
  int worse = 0;
  for (int iteration = 0; iteration < most_iterations; ++iteration) {
    const ContactSum springs = springs_at(contacts, step);
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
