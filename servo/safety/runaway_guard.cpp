// SPDX-License-Identifier: Apache-2.0
#include "servo/safety/runaway_guard.hpp"

#include <Eigen/Cholesky>
#include <algorithm>
#include <cmath>

namespace spm::servo {

namespace {

constexpr double strong = 0.5;     // of the cap
constexpr double weak = 1.0 / 16;  // of the force now
constexpr double least_share = 0.1, most_share = 1.5;
constexpr double most_aside = 0.25;          // of what the force gives
constexpr double most_left = 0.1;            // of what the force explains
constexpr double sure = 6;                   // standard deviations
constexpr std::uint64_t most_left_out = 20;  // ticks

}  // namespace

bool RunawayGuard::runs_away(const Vector3& hand, std::uint64_t tick, double cap) noexcept {
  // Ticks that were left out are told by the numbers; where many were, others may have acted.
  if (count_ > 0 && (tick <= before(0).number || tick - before(0).number > most_left_out)) forget();
  last_ = (last_ + 1) % kept;
  ticks_[last_] = {tick, hand, Vector3::Zero()};
  count_ = std::min(count_ + 1, kept);
  if (count_ < 2 || !(settings_.moving_mass > 0) || !(cap > 0)) return false;
  const Vector3& force = before(1).force;
  const double size = force.norm();
  if (!(size >= strong * cap)) return false;
  const Vector3 along = force / size;
  const std::size_t grown = growth(along, weak * size);
  if (grown < fewest) return false;
  return follows(along, size, std::min(2 * grown, count_ - 1));
}

void RunawayGuard::sent(const Vector3& force) noexcept {
  if (count_ > 0) ticks_[last_].force = force;
}

/// For how many ticks the force was stronger than `least`; 0 if longer than is kept.
std::size_t RunawayGuard::growth(const Vector3& along, double least) const noexcept {
  for (std::size_t ticks = 2; ticks < count_; ++ticks) {
    if (before(ticks).force.dot(along) <= least) return ticks;
  }
  return 0;
}

/// Whether the hand's way against the force, over the last so many ticks, follows the force.
bool RunawayGuard::follows(const Vector3& along, double force, std::size_t ticks) const noexcept {
  const double mass = settings_.moving_mass;
  const Tick& start = before(ticks);
  const double time = settings_.tick * static_cast<double>(before(0).number - start.number);
  // Of the way and of the force integrated twice: moments with 1, tau and tau^2, tau from -1 to 1.
  Eigen::Matrix3d moments = Eigen::Matrix3d::Zero();
  Vector3 of_way = Vector3::Zero(), of_push = Vector3::Zero();
  double way_way = 0, way_push = 0, push_push = 0;
  double speed = 0, push = 0, passed = 0;  // N s and N s2: force, integrated once and twice; s
  for (std::size_t i = 0; i <= ticks; ++i) {
    const Tick& now = before(ticks - i);
    const double tau = 2 * passed / time - 1;
    const Vector3 powers(1, tau, tau * tau);
    const double way = along.dot(start.hand - now.hand);
    moments += powers * powers.transpose();
    of_way += way * powers;
    of_push += push * powers;
    way_way += way * way;
    way_push += way * push;
    push_push += push * push;
    if (i == ticks) break;
    const double drive = along.dot(now.force);
    const double step =
        settings_.tick * static_cast<double>(before(ticks - i - 1).number - now.number);
    push += speed * step + drive * step * step / 2;
    speed += drive * step;
    passed += step;
  }
  const Eigen::LDLT<Eigen::Matrix3d> solver(moments);
  const Vector3 way_fit = solver.solve(of_way), push_fit = solver.solve(of_push);
  // What of both no constant force and no speed at the start explains.
  const double push_left = push_push - of_push.dot(push_fit);
  const double way_left = way_way - of_way.dot(way_fit);
  const double both_left = way_push - of_way.dot(push_fit);
  if (!(push_left > 0) || !(both_left > 0)) return false;
  const double mobility = both_left / push_left;  // 1/kg
  const double share = mass * mobility;
  if (share < least_share || share > most_share) return false;
  const double rounding = settings_.encoder_step / std::sqrt(12.0);
  if (share < sure * mass * rounding / std::sqrt(push_left)) return false;

  const double explained = mobility * both_left;
  const double unexplained = std::max(0.0, way_left - explained);
  const double samples = static_cast<double>(ticks) + 1;
  const double rest = settings_.encoder_step / 2;
  if (unexplained > std::max(rest * rest * samples, most_left * most_left * explained)) {
    return false;
  }
  const double aside = 8 * (way_fit[2] - mobility * push_fit[2]) / (time * time);
  return mass * std::abs(aside) <= most_aside * share * force;
}

}  // namespace spm::servo
