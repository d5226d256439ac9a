// SPDX-License-Identifier: GPL-3.0-or-later
#include "tests/stability/laboratory/judges.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <limits>

#include "common/base/units.hpp"

namespace spm::stability {
namespace {

constexpr double infinity = std::numeric_limits<double>::infinity();

/// The ticks of a run that belong to its hold, and half of the moving mean's window.
struct Hold {
  std::size_t first = 0, end = 0;
  std::size_t half = 0;  ///< ticks
};

Hold hold_of(const Trace& trace) {
  const auto ticks_in = [&](double seconds) {
    return static_cast<std::size_t>(std::lround(seconds / trace.period));
  };
  const std::size_t count = trace.ticks.size();
  return {count - std::min(count, ticks_in(hold_seconds)), count, ticks_in(mean_seconds / 2)};
}

/// The rest of a vector in the hold after the mean of a window about each tick is subtracted; only
/// where the window is whole.
struct Residual {
  double squares = 0;  ///< mean of the squared lengths
  double swing = 0;    ///< peak to peak, of the axis where it is largest
};

Residual residual_of(const Trace& trace, const Hold& hold, Vector3 TraceTick::*member) {
  Residual residual;
  const std::size_t first = std::max(hold.first, hold.half);
  if (first + hold.half >= hold.end) return residual;
  const auto window = static_cast<double>(2 * hold.half + 1);
  Vector3 sum = Vector3::Zero();
  for (std::size_t i = first - hold.half; i <= first + hold.half; ++i) {
    sum += trace.ticks[i].*member;
  }
  Vector3 low = Vector3::Constant(infinity), high = Vector3::Constant(-infinity);
  std::size_t count = 0;
  for (std::size_t i = first; i + hold.half < hold.end; ++i, ++count) {
    const Vector3 rest = trace.ticks[i].*member - sum / window;
    residual.squares += rest.squaredNorm();
    low = low.cwiseMin(rest);
    high = high.cwiseMax(rest);
    if (i + hold.half + 1 < hold.end) {
      sum += trace.ticks[i + hold.half + 1].*member - trace.ticks[i - hold.half].*member;
    }
  }
  residual.squares /= static_cast<double>(count);
  residual.swing = (high - low).maxCoeff();
  return residual;
}

/// How far a tool at rest may move, m.
double motion_limit(const JudgedLoop& loop) {
  return std::max(bad_motion_steps * loop.encoder_step, bad_motion);
}

/// The largest net work that the actuators did up to any time, less what a moved object put in.
double generated(const Trace& trace) {
  double sum = 0, largest = 0;
  for (const TraceTick& tick : trace.ticks) {
    sum += tick.work - tick.surface_work;
    largest = std::max(largest, sum);
  }
  return largest;
}

/// The largest net work that the field itself did on a tool that is carried. It uses the trapezoid
/// rule, since held forces leak a little in every field.
double field_work(const Trace& trace) {
  double sum = 0, largest = 0;
  for (std::size_t i = 1; i < trace.ticks.size(); ++i) {
    const TraceTick& from = trace.ticks[i - 1];
    const TraceTick& to = trace.ticks[i];
    sum += (from.commanded + to.commanded).dot(to.position - from.position) / 2;
    largest = std::max(largest, sum);
  }
  return largest;
}

double generated_bound(const JudgedLoop& loop, const Trace& trace) {
  double speed = 0, force = 0;
  for (const TraceTick& tick : trace.ticks) {
    // A delayed force still acts after contact is over.
    if (!tick.contact && tick.work == 0) continue;
    speed = std::max(speed, tick.velocity.norm());
    force = std::max(force, tick.commanded.norm());
  }
  if (loop.force_cap > 0) force = std::min(force, loop.force_cap);
  const double step = speed * trace.period;
  return 2 * (loop.stiffness * (0.5 + loop.delay + loop.lag / trace.period) * step * step +
              force * loop.encoder_step);
}

/// Height of the first touch along the normal, relative to the object; NaN where the tool never
/// touched.
double touched_height(const StabilityCase& tried, const Trace& trace) {
  for (const TraceTick& tick : trace.ticks) {
    if (tick.contact) return (tick.position - tick.surface).dot(tried.normal);
  }
  return std::numeric_limits<double>::quiet_NaN();
}

/// The force that the hand would press with at the end if the surface held it, N.
double pressed_force(const StabilityCase& tried, const JudgedLoop& loop, const Trace& trace,
                     double touched) {
  const TraceTick& last = trace.ticks.back();
  double pressed = tried.pressed;
  if (!std::isfinite(pressed)) pressed = touched - (last.target - last.surface).dot(tried.normal);
  // A tool that is carried is held rigidly.
  const double spring = tried.is_carried          ? loop.stiffness
                        : loop.hand_stiffness > 0 ? loop.stiffness * loop.hand_stiffness /
                                                        (loop.stiffness + loop.hand_stiffness)
                                                  : 0;
  const double friction = tried.is_carried ? 0 : loop.friction;
  const double force = spring * pressed - friction;
  return force > 0 ? force : 0;
}

/// Time, s, from which the tool stays where it ends; infinite where it moves in the hold.
double settled_time(const JudgedLoop& loop, const Trace& trace, const Hold& hold) {
  Vector3 sum = Vector3::Zero();
  for (std::size_t i = hold.first; i < hold.end; ++i) sum += trace.ticks[i].position;
  const Vector3 rest = sum / static_cast<double>(hold.end - hold.first);
  for (std::size_t i = hold.end; i > 0; --i) {
    if ((trace.ticks[i - 1].position - rest).norm() <= motion_limit(loop)) continue;
    return i > hold.first ? infinity : trace.ticks[i - 1].time + trace.period;
  }
  return 0;
}

/// Whether the hand and the object rest in the hold, so that the tool should rest as well.
bool should_rest(const JudgedLoop& loop, const Trace& trace, const Hold& hold) {
  const TraceTick& first = trace.ticks[hold.first];
  const TraceTick& last = trace.ticks[hold.end - 1];
  return (last.target - first.target).norm() + (last.surface - first.surface).norm() <=
         motion_limit(loop);
}

std::string newtons(double force) { return fmt::format("{:.3g} N", force); }

/// Collects what is wrong.
class Judgement {
 public:
  explicit Judgement(Verdict& verdict) : verdict_(verdict) {}
  void fails(const std::string& reason) {
    verdict_.bad = true;
    passes_not(reason);
  }
  void passes_not(const std::string& reason) {
    verdict_.good = false;
    if (!verdict_.reason.empty()) verdict_.reason += "; ";
    verdict_.reason += reason;
  }

 private:
  Verdict& verdict_;
};

void judge_ripple(const JudgedLoop& loop, const Findings& found, Judgement& judgement) {
  if (found.ripple_n > bad_ripple) {
    judgement.fails("ripple of " + newtons(found.ripple_n) + " RMS");
  } else if (!(found.ripple_n < good_ripple)) {
    judgement.passes_not("ripple of " + newtons(found.ripple_n) + " RMS");
  }
  if (found.ripple_m > motion_limit(loop)) {
    judgement.fails("the tool swings by " + format_quantity(found.ripple_m, Quantity::length));
  }
}

}  // namespace

Findings find(const StabilityCase& tried, const JudgedLoop& loop, const Trace& trace) {
  Findings found;
  if (trace.ticks.empty()) return found;
  const Hold hold = hold_of(trace);
  found.ripple_n = std::sqrt(residual_of(trace, hold, &TraceTick::commanded).squares);
  found.ripple_m = residual_of(trace, hold, &TraceTick::position).swing;
  if (std::isfinite(tried.judged.max_gained)) {
    found.generated_j = field_work(trace);
    found.generated_bound_j = tried.judged.max_gained * loop.stiffness / 1000;
  } else {
    found.generated_j = generated(trace);
    found.generated_bound_j = generated_bound(loop, trace);
  }
  const double touched = touched_height(tried, trace);
  double held = 0;
  for (std::size_t i = 0; i < trace.ticks.size(); ++i) {
    const TraceTick& tick = trace.ticks[i];
    if (i >= hold.first) held += tick.commanded.dot(tried.normal);
    if (!tick.contact) continue;
    const double below = touched - (tick.position - tick.surface).dot(tried.normal);
    found.penetration_m = std::max(found.penetration_m, below);
  }
  found.held_n = held / static_cast<double>(hold.end - hold.first);
  found.pressed_n = pressed_force(tried, loop, trace, touched);
  found.popped = !std::isfinite(touched) ||
                 (found.pressed_n > 0 && found.held_n < pop_share * found.pressed_n);
  found.settled_s = settled_time(loop, trace, hold);
  return found;
}

Verdict judge(const StabilityCase& tried, const JudgedLoop& loop, const Trace& trace) {
  Verdict verdict;
  verdict.findings = find(tried, loop, trace);
  const Findings& found = verdict.findings;
  Judgement judgement(verdict);
  const Judged& judged = tried.judged;
  if (judged.pop && found.popped) {
    judgement.fails(fmt::format("popped through: {} held, the hand presses with {}",
                                newtons(found.held_n), newtons(found.pressed_n)));
  }
  if (judged.ripple && !trace.ticks.empty()) judge_ripple(loop, found, judgement);
  if (judged.settles && !tried.is_carried && !trace.ticks.empty() &&
      should_rest(loop, trace, hold_of(trace)) && !std::isfinite(found.settled_s)) {
    judgement.passes_not("it does not come to rest");
  }
  if (found.penetration_m > judged.longest_penetration) {
    judgement.fails("penetrates by " + format_quantity(found.penetration_m, Quantity::length));
  }
  if (judged.energy) {
    verdict.within_energy = found.generated_j <= found.generated_bound_j;
    if (!verdict.within_energy && tried.is_carried) {
      const std::string reason =
          fmt::format("generates {:.3g} uJ, bound {:.3g} uJ", 1e6 * found.generated_j,
                      1e6 * found.generated_bound_j);
      if (found.generated_j > 2 * found.generated_bound_j) {
        judgement.fails(reason);
      } else {
        judgement.passes_not(reason);
      }
    }
  }
  return verdict;
}

double envelope_ratio(const Trace& trace) {
  const std::size_t count = trace.ticks.size();
  const auto peak = [&](std::size_t first, std::size_t end) {
    double largest = 0;
    for (std::size_t i = first; i < end; ++i) {
      largest = std::max(largest, trace.ticks[i].velocity.squaredNorm());
    }
    return largest;
  };
  const double before = peak(count / 4, count / 2);
  const double after = peak(count - count / 4, count);
  if (after == 0) return 0;
  return before > 0 ? after / before : infinity;
}

}  // namespace spm::stability
