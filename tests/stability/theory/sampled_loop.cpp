// SPDX-License-Identifier: GPL-3.0-or-later
#include "tests/stability/theory/sampled_loop.hpp"

#include <Eigen/Dense>
#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>
#include <unsupported/Eigen/MatrixFunctions>

namespace spm::stability {
namespace {

using Eigen::MatrixXd;
using Eigen::VectorXd;

constexpr double scan_step = 1.05;  // ratio of stiffnesses between which one border may lie
constexpr double found_share = 1e-9;

/// The continuous part x' = A x + e u, u the force that was sent: tool's position and velocity,
/// arm's the same, actuator's force; the last three only where there are any.
struct Continuous {
  MatrixXd rate;
  VectorXd entry;
};

Continuous continuous_part(const SampledLoop& loop) {
  const bool has_arm = loop.hand == servo::HandModel::arm;
  const bool has_grip = loop.hand != servo::HandModel::none;
  const bool has_lag = loop.lag > 0;
  const Eigen::Index size = 2 + (has_arm ? 2 : 0) + (has_lag ? 1 : 0);
  const double stiffness = has_grip ? servo::grip_stiffness : 0;
  const double damping = has_grip ? servo::grip_damping : 0;
  Continuous part{MatrixXd::Zero(size, size), VectorXd::Zero(size)};
  part.rate(0, 1) = 1;
  part.rate(1, 0) = -stiffness / loop.mass;
  part.rate(1, 1) = -(damping + loop.device_damping) / loop.mass;
  if (has_arm) {
    part.rate(1, 2) = stiffness / loop.mass;
    part.rate(1, 3) = damping / loop.mass;
    part.rate(2, 3) = 1;
    part.rate(3, 0) = stiffness / servo::arm_mass;
    part.rate(3, 1) = damping / servo::arm_mass;
    part.rate(3, 2) = -(stiffness + servo::arm_stiffness) / servo::arm_mass;
    part.rate(3, 3) = -(damping + servo::arm_damping) / servo::arm_mass;
  }
  if (has_lag) {
    part.rate(1, size - 1) = 1 / loop.mass;
    part.rate(size - 1, size - 1) = -1 / loop.lag;
    part.entry(size - 1) = 1 / loop.lag;
  } else {
    part.entry(1) = 1 / loop.mass;
  }
  return part;
}

/// What a time (s) does to the state, and what a force held over it adds.
struct Transition {
  MatrixXd free;
  VectorXd forced;
};

Transition transition(const Continuous& part, double time) {
  const Eigen::Index size = part.entry.size();
  MatrixXd both = MatrixXd::Zero(size + 1, size + 1);
  both.topLeftCorner(size, size) = part.rate * time;
  both.topRightCorner(size, 1) = part.entry * time;
  const MatrixXd moved = both.exp();
  return {moved.topLeftCorner(size, size), moved.topRightCorner(size, 1)};
}

/// The loop's map from a tick's begin to the next, split so that it is linear in the stiffness. The
/// state: the continuous part, the last reading, the last filtered velocity, forces on their way,
/// the newest first.
class TickMap {
 public:
  explicit TickMap(const SampledLoop& loop) : loop_(loop), part_(continuous_part(loop)) {
    const double whole = std::floor(loop.delay_ticks);
    fraction_ = loop.delay_ticks - whole;
    waiting_ = static_cast<Eigen::Index>(whole) + 1;
    before_ = transition(part_, fraction_ * loop.period);
    after_ = transition(part_, (1 - fraction_) * loop.period);
  }

  [[nodiscard]] double radius(double stiffness) const {
    const Eigen::Index inner = part_.entry.size();
    const Eigen::Index size = inner + 2 + waiting_;
    const Eigen::Index reading = inner, velocity = inner + 1, forces = inner + 2;
    const double kept =
        loop_.filter > 0 ? std::exp(-2 * std::numbers::pi * loop_.filter * loop_.period) : 0;
    Eigen::RowVectorXd speed = Eigen::RowVectorXd::Zero(size);
    speed(0) = (1 - kept) / loop_.period;
    speed(reading) = -(1 - kept) / loop_.period;
    speed(velocity) = kept;
    Eigen::RowVectorXd sent = -loop_.damping * speed;
    sent(0) -= stiffness;

    MatrixXd map = MatrixXd::Zero(size, size);
    map.topLeftCorner(inner, inner) = after_.free * before_.free;
    // Until the fraction has passed the older force acts, then the newer one.
    const VectorXd of_older = after_.free * before_.forced;
    map.block(0, forces + waiting_ - 1, inner, 1) += of_older;
    if (waiting_ == 1) {
      map.topRows(inner) += after_.forced * sent;
    } else {
      map.block(0, forces + waiting_ - 2, inner, 1) += after_.forced;
    }
    map(reading, 0) = 1;
    map.row(velocity) = speed;
    map.row(forces) = sent;
    for (Eigen::Index i = 1; i < waiting_; ++i) map(forces + i, forces + i - 1) = 1;
    return Eigen::EigenSolver<MatrixXd>(map, false).eigenvalues().cwiseAbs().maxCoeff();
  }

 private:
  SampledLoop loop_;
  Continuous part_;
  double fraction_ = 0;
  Eigen::Index waiting_ = 1;
  Transition before_, after_;
};

}  // namespace

double spectral_radius(const SampledLoop& loop) { return TickMap(loop).radius(loop.stiffness); }

double border_stiffness(SampledLoop loop, double low, double high) {
  const TickMap map(loop);
  if (map.radius(low) >= 1) return 0;
  double stable = low, unstable = low;
  while (true) {
    if (stable >= high) return std::numeric_limits<double>::infinity();
    unstable = stable * scan_step;
    if (map.radius(unstable) >= 1) break;
    stable = unstable;
  }
  while (unstable / stable - 1 > found_share) {
    const double middle = std::sqrt(stable * unstable);
    (map.radius(middle) < 1 ? stable : unstable) = middle;
  }
  return std::sqrt(stable * unstable);
}

double approximate_border(const SampledLoop& loop) noexcept {
  const double late = loop.period / 2 + loop.delay_ticks * loop.period + loop.lag;
  return (loop.device_damping + loop.damping) / late;
}

double passive_border(const SampledLoop& loop) noexcept {
  return std::max(0.0, 2 * (loop.device_damping - std::abs(loop.damping)) / loop.period);
}

double delayed_passive_border(const SampledLoop& loop) noexcept {
  return loop.device_damping / (loop.period * (0.5 + loop.delay_ticks));
}

double quantised_passive_border(const SampledLoop& loop, double friction,
                                double encoder_step) noexcept {
  return std::min(2 * loop.device_damping / loop.period, 2 * friction / encoder_step);
}

}  // namespace spm::stability
