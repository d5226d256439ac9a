// SPDX-License-Identifier: GPL-3.0-or-later
#include "tests/stability/laboratory/loop_energy.hpp"

#include <tbb/parallel_for.h>

#include <algorithm>
#include <cmath>
#include <numbers>

#include "common/base/random.hpp"
#include "tests/bench/base/quantile.hpp"
#include "tests/stability/laboratory/contestants.hpp"

namespace spm::stability {
namespace {

constexpr int tries_a_loop = 20;

/// A flat ellipse's circumference over its longer semi-axis (Ramanujan's first approximation, off
/// by less than 0.1 % for these).
double circumference(double longer, double shorter) {
  return std::numbers::pi *
         (3 * (longer + shorter) - std::sqrt((3 * longer + shorter) * (longer + 3 * shorter)));
}

/// The longer semi-axis of an ellipse with the given circumference; by bisection.
double longer_axis(double length, double shorter) {
  double low = 0, high = length;
  for (int i = 0; i < 60; ++i) {
    const double middle = (low + high) / 2;
    (circumference(middle, shorter) < length ? low : high) = middle;
  }
  return low;
}

std::vector<Vector3> ellipse(const Vector3& centre, const Vector3& one, const Vector3& other,
                             std::size_t count) {
  std::vector<Vector3> points;
  points.reserve(count);
  for (std::size_t i = 0; i < count; ++i) {
    const double turn = 2 * std::numbers::pi * static_cast<double>(i) / static_cast<double>(count);
    points.push_back(centre + std::cos(turn) * one + std::sin(turn) * other);
  }
  return points;
}

/// Work between two places, by the mean of the forces there.
double work_between(const Vector3& force, const Vector3& next_force, const Vector3& way) {
  return (force + next_force).dot(way) / 2;
}

/// Whether a ball is free of the surface.
bool is_free(const baker::ExactSurface& surface, const Vector3& place, double radius) {
  return !surface.inside(place) && (surface.closest(place).position - place).norm() > radius;
}

}  // namespace

std::vector<ClosedLoop> closed_loops(const StabilityCase& tried, const LoopPlan& plan) {
  const baker::ExactSurface& surface = prepared_object(tried).model().truth;
  const double radius = tried.probe_radius;
  const double shorter = (plan.max_depth - plan.min_depth) / 2;
  const double longer = longer_axis(plan.length, shorter);
  const double round = plan.length / (2 * std::numbers::pi);
  const auto count = static_cast<std::size_t>(std::lround(plan.length / plan.step));
  Random random(plan.seed);
  std::vector<ClosedLoop> loops;
  for (std::size_t tries = 0; loops.size() < plan.loops && tries < tries_a_loop * plan.loops;
       ++tries) {
    const double choice = random.between(0, 1), a = random.between(0, 1), b = random.between(0, 1);
    const baker::SurfacePoint place = surface.at(choice, a, b);
    const Vector3 any = random.direction();
    const double depth = random.between(plan.min_depth, plan.max_depth);
    const Vector3 along = (any - any.dot(place.normal) * place.normal).normalized();
    const auto below = [&](double deep) -> Vector3 {
      return place.position + (radius - deep) * place.normal;
    };
    ClosedLoop loop;
    loop.from = below(-plan.min_depth);
    if (!is_free(surface, loop.from, radius)) continue;
    loop.points = loops.size() % 2 == 0 ? ellipse(below(depth), round * along,
                                                  round * along.cross(place.normal), count)
                                        : ellipse(below(plan.min_depth + shorter), longer * along,
                                                  shorter * place.normal, count);
    loops.push_back(std::move(loop));
  }
  return loops;
}

double loop_work(Contestant& contestant, const ClosedLoop& loop, double step) {
  const Vector3 still = Vector3::Zero();
  contestant.begin(loop.from);
  const Vector3 way = loop.points.front() - loop.from;
  const auto steps = static_cast<std::size_t>(std::ceil(way.norm() / step));
  for (std::size_t i = 0; i < steps; ++i) {
    const double share = static_cast<double>(i) / static_cast<double>(steps);
    static_cast<void>(contestant.next(loop.from + share * way, still));
  }
  Vector3 place = loop.points.front();
  Vector3 force = contestant.next(place, still).force;
  double work = 0;
  for (const bool counts : {false, true}) {
    for (std::size_t i = 1; i <= loop.points.size(); ++i) {
      const Vector3& next = loop.points[i % loop.points.size()];
      const Vector3 next_force = contestant.next(next, still).force;
      if (counts) work += work_between(force, next_force, next - place);
      place = next;
      force = next_force;
    }
  }
  return work;
}

LoopEnergy loop_energy(const StabilityCase& tried, const Contender& contender,
                       const LoopPlan& plan) {
  const std::vector<ClosedLoop> loops = closed_loops(tried, plan);
  RunSettings settings;
  settings.stiffness = plan.stiffness;
  std::vector<double> gains(loops.size());
  tbb::parallel_for(std::size_t{0}, loops.size(), [&](std::size_t i) {
    const auto contestant = make_contestant(contender, prepared_object(tried), tried, settings);
    ClosedLoop reversed = loops[i];
    std::reverse(reversed.points.begin(), reversed.points.end());
    gains[i] = std::max(loop_work(*contestant, loops[i], plan.step),
                        loop_work(*contestant, reversed, plan.step));
  });
  LoopEnergy energy;
  energy.loops = loops.size();
  if (gains.empty()) return energy;
  const auto largest = std::max_element(gains.begin(), gains.end());
  energy.largest_j = *largest;
  energy.worst = static_cast<std::size_t>(largest - gains.begin());
  energy.median_j = bench::quantile(gains, 0.5);
  return energy;
}

}  // namespace spm::stability
