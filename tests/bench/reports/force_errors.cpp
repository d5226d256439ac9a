// SPDX-License-Identifier: GPL-3.0-or-later
#include "tests/bench/reports/force_errors.hpp"

#include <cmath>
#include <cstddef>
#include <utility>

#include "tests/bench/base/quantile.hpp"

namespace spm::bench {
namespace {

enum class Cause { none, free, deep, contested };

/// Why a tick is not judged, or none.
Cause cause_of(const ExactTick& tick, double max_depth, double radius) {
  if (!(tick.distance < radius)) return Cause::free;
  if (tick.distance < -max_depth) return Cause::deep;
  return tick.contested ? Cause::contested : Cause::none;
}

double angle_between(const Vector3& a, const Vector3& b) {
  return std::atan2(a.cross(b).norm(), a.dot(b));
}

}  // namespace

Vector3 exact_penalty(const ExactTick& tick, double stiffness, double radius) {
  if (!(tick.distance < radius)) return Vector3::Zero();
  return stiffness * (radius - tick.distance) * tick.outward;
}

Quantiles quantiles_of(std::vector<double> values) {
  Quantiles result;
  result.count = values.size();
  result.p50 = quantile(values, 0.5);
  result.p99 = quantile(values, 0.99);
  result.p999 = quantile(values, 0.999);
  result.max = quantile(values, 1);
  return result;
}

JudgedTicks count_judged(std::span<const ExactTick> ticks, double max_depth, double radius) {
  JudgedTicks counts;
  for (const ExactTick& tick : ticks) {
    const Cause cause = cause_of(tick, max_depth, radius);
    if (cause == Cause::free) continue;
    ++counts.contacts;
    if (cause == Cause::deep) ++counts.deep;
    if (cause == Cause::contested) ++counts.contested;
    if (cause == Cause::none) ++counts.judged;
  }
  return counts;
}

ForceErrors force_errors(std::span<const ExactTick> ticks, std::span<const Vector3> forces,
                         const ForceRules& rules) {
  ForceErrors errors;
  double exact_squares = 0, difference_squares = 0;
  std::uint64_t judged = 0;
  std::vector<double> angles, steps, excess, clear_excess;
  Vector3 last_exact = Vector3::Zero();
  bool last_judged = false;
  for (std::size_t i = 0; i < ticks.size(); ++i) {
    const ExactTick& tick = ticks[i];
    const Vector3 exact = exact_penalty(tick, rules.stiffness, rules.radius);
    const Cause cause = cause_of(tick, rules.max_depth, rules.radius);
    const bool pushes = !forces[i].isZero(0);
    if (cause == Cause::none) {
      ++judged;
      exact_squares += exact.squaredNorm();
      difference_squares += (forces[i] - exact).squaredNorm();
      if (!pushes) ++errors.missing;
      if (pushes && !exact.isZero(0)) angles.push_back(angle_between(forces[i], exact));
    }
    if (pushes && tick.distance > rules.radius + rules.slack) ++errors.spurious;
    const bool step_known = i > 0 && !tick.fresh && tick.sliding && ticks[i - 1].sliding;
    if (step_known) {
      const double step = (forces[i] - forces[i - 1]).norm();
      const double exact_step = (exact - last_exact).norm();
      steps.push_back(step);
      if (exact_step < smooth_step) {
        excess.push_back(step - exact_step);
        if (cause == Cause::none && last_judged) clear_excess.push_back(excess.back());
      }
    }
    last_exact = exact;
    last_judged = cause == Cause::none;
  }
  if (judged > 0) {
    errors.exact_rms = std::sqrt(exact_squares / static_cast<double>(judged));
    errors.difference_rms = std::sqrt(difference_squares / static_cast<double>(judged));
  }
  errors.direction = quantiles_of(std::move(angles));
  errors.step = quantiles_of(std::move(steps));
  errors.excess = quantiles_of(std::move(excess));
  errors.clear_excess = quantiles_of(std::move(clear_excess));
  return errors;
}

}  // namespace spm::bench
