// SPDX-License-Identifier: GPL-3.0-or-later
#include "tests/stability/laboratory/laboratory.hpp"

#include <tbb/parallel_for.h>

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <numbers>

#include "common/base/random.hpp"
#include "servo/devices/sim/actuator_line.hpp"
#include "tests/stability/laboratory/contestants.hpp"
#include "tests/stability/objects/hand_script.hpp"
#include "tests/stability/objects/prepared_object.hpp"

namespace spm::stability {
namespace {

constexpr std::uint64_t offset_seed = 0x6F6666736574;
/// Factor by which a border's search steps up: the fourth root of 2.
constexpr double border_steps = 1.189207115002721;
/// Factor from a stiffness that fails to its two neighbours that may excuse it.
constexpr double chance_share = 1.01;

/// Offset of the hand's path between encoder steps, m, so that no run begins on a step by chance.
Vector3 path_offset(double encoder_step, std::uint64_t seed) {
  Random random(seed ^ offset_seed);
  Vector3 offset;
  for (double& along : offset) along = random.between(-0.5, 0.5) * encoder_step;
  return offset;
}

/// The work that a moved object put in from one tick to the next: the mean of the forces on the
/// tool before and after, times the object's displacement. An object that came from outside pushed
/// no farther than it now reaches over the tool.
double surface_work(const TraceTick* before, const TraceTick& now) {
  if (before == nullptr) return 0;
  const Vector3 way = now.surface - before->surface;
  if (way.isZero(0)) return 0;
  if (before->contact) return (before->commanded + now.commanded).dot(way) / 2;
  const double pushed = now.commanded.dot(way) / 2;
  return std::min(pushed, now.commanded.norm() * now.depth / 2);
}

/// A simulated device in a hand.
class HeldTool {
 public:
  HeldTool(const StabilityCase& tried, const RunSettings& settings)
      : plant_(plant_settings(tried, settings)),
        script_(tried, path_offset(plant_.settings().encoder_step, settings.seed)) {
    plant_.place(script_.at(0).position);
  }

  void read(TraceTick& tick) const {
    tick.target = script_.at(tick.time).position;
    tick.position = plant_.position();
    tick.velocity = plant_.velocity();
    tick.measured = plant_.measured_position();
  }

  void step(TraceTick& tick) {
    const double end = tick.time + plant_.settings().period;
    const servo::PlantTick done = plant_.step(tick.commanded, script_.at(end));
    tick.hand_force = done.hand_force;
    tick.work = done.work;
  }

 private:
  servo::SimPlant plant_;
  HandScript script_;
};

/// A tool that is led along the hand's path whatever pushes it: its device only reads and delays.
class CarriedTool {
 public:
  CarriedTool(const StabilityCase& tried, const RunSettings& settings)
      : plant_(plant_settings(tried, settings)),
        script_(tried, Vector3::Zero()),
        line_(line_settings(plant_.settings())) {}

  void read(TraceTick& tick) {
    const servo::HandTarget target = script_.at(tick.time);
    plant_.place(target.position);
    tick.target = tick.position = target.position;
    tick.velocity = target.velocity;
    tick.measured = plant_.measured_position();
  }

  void step(TraceTick& tick) {
    line_.command(tick.commanded);
    const Vector3 force = line_.mean_force(0, 1);
    tick.hand_force = -force;
    const double end = tick.time + plant_.settings().period;
    tick.work = force.dot(script_.at(end).position - tick.position);
  }

 private:
  /// Without the actuator's lag.
  static servo::ActuatorSettings line_settings(const servo::PlantSettings& plant) {
    return {plant.period,     plant.delay_ticks,       plant.jitter,
            plant.lost_share, plant.profile.force_cap, 0,
            plant.seed};
  }

  servo::SimPlant plant_;
  HandScript script_;
  servo::ActuatorLine line_;
};

template <class Tool>
Trace run(const StabilityCase& tried, const RunSettings& settings, Contestant& contestant) {
  Tool tool(tried, settings);
  Trace trace;
  trace.period = settings.period;
  trace.ticks.resize(static_cast<std::size_t>(std::lround(tried.seconds / settings.period)));
  const TraceTick* before = nullptr;
  for (std::size_t i = 0; i < trace.ticks.size(); ++i) {
    TraceTick& tick = trace.ticks[i];
    tick.time = static_cast<double>(i) * settings.period;
    tool.read(tick);
    if (i == 0) contestant.begin(tick.position);
    if (tried.surface) tick.surface = tried.surface(tick.time);
    const ContactForce contact = contestant.next(tick.measured, tick.surface);
    tick.commanded = contact.force;
    tick.depth = contact.depth;
    tick.contact = contact.contact;
    tick.surface_work = surface_work(before, tick);
    tool.step(tick);
    before = &tick;
  }
  return trace;
}

/// Whether one verdict is worse than another: by its kind first, then by its ripple.
bool is_worse(const Verdict& one, const Verdict& other) {
  const auto rank = [](const Verdict& verdict) { return verdict.bad ? 2 : verdict.good ? 0 : 1; };
  if (rank(one) != rank(other)) return rank(one) > rank(other);
  return one.findings.ripple_n > other.findings.ripple_n;
}

int seeds_of(const StabilityCase& tried, int most) {
  return std::max(1, std::min(tried.seeds, most));
}

RunSettings with_seed(RunSettings settings, int which) {
  settings.seed += static_cast<std::uint64_t>(which);
  return settings;
}

}  // namespace

servo::PlantSettings plant_settings(const StabilityCase& tried, const RunSettings& settings) {
  servo::PlantSettings plant;
  plant.profile = *settings.profile;
  plant.profile.damping += settings.damping;
  plant.period = settings.period;
  plant.hand = tried.holder;
  plant.mass = settings.mass;
  plant.delay_ticks = tried.delay_ticks;
  plant.lost_share = tried.lost_share;
  plant.friction_scale = tried.friction_scale;
  plant.encoder_step = tried.encoder_step < 0 ? plant.profile.encoder_step : tried.encoder_step;
  plant.noise = tried.noise;
  plant.seed = settings.seed;
  plant.substeps = servo::substeps_for(settings.period);
  return plant;
}

JudgedLoop judged_loop(const StabilityCase& tried, const RunSettings& settings) {
  const servo::PlantSettings plant = plant_settings(tried, settings);
  JudgedLoop loop;
  loop.stiffness = settings.stiffness;
  loop.delay = tried.delay_ticks;
  if (!tried.is_carried && plant.profile.bandwidth > 0) {
    loop.lag = 1 / (2 * std::numbers::pi * plant.profile.bandwidth);
  }
  loop.encoder_step = plant.encoder_step;
  loop.force_cap = plant.profile.force_cap;
  loop.friction = plant.profile.friction * plant.friction_scale;
  if (tried.holder == servo::HandModel::spring) {
    loop.hand_stiffness = servo::grip_stiffness;
  } else if (tried.holder == servo::HandModel::arm) {
    loop.hand_stiffness = servo::grip_stiffness * servo::arm_stiffness /
                          (servo::grip_stiffness + servo::arm_stiffness);
  }
  return loop;
}

Trace run_case(const StabilityCase& tried, const RunSettings& settings, Contestant& contestant) {
  return tried.is_carried ? run<CarriedTool>(tried, settings, contestant)
                          : run<HeldTool>(tried, settings, contestant);
}

CaseResult run_and_judge(const StabilityCase& tried, const RunSettings& settings,
                         const Contender& contender) {
  const auto contestant = make_contestant(contender, prepared_object(tried), tried, settings);
  CaseResult result;
  result.trace = run_case(tried, settings, *contestant);
  result.verdict = judge(tried, judged_loop(tried, settings), result.trace);
  return result;
}

CaseVerdict gathered(const std::vector<Verdict>& verdicts, std::uint64_t first_seed) {
  CaseVerdict all;
  all.seeds = static_cast<int>(verdicts.size());
  for (std::size_t i = 0; i < verdicts.size(); ++i) {
    if (verdicts[i].good) ++all.good_seeds;
    if (verdicts[i].bad) ++all.bad_seeds;
    if (i > 0 && !is_worse(verdicts[i], all.worst)) continue;
    all.worst = verdicts[i];
    all.worst_seed = first_seed + i;
  }
  return all;
}

double stiffest(const std::function<bool(double)>& is_good, double low, double high, double share) {
  // By chance some tools rest on the edge of an encoder step, and there they are never quiet.
  const auto holds = [&is_good](double stiffness) {
    return is_good(stiffness) ||
           (is_good(stiffness / chance_share) && is_good(stiffness * chance_share));
  };
  // Below the stiffness that a law needs to hold the tool at all, the tool sinks through.
  while (!holds(low)) {
    low *= border_steps;
    if (low > high) return 0;
  }
  double fails = low;
  do {
    low = fails;
    if (low >= high) return high;
    fails = std::min(low * border_steps, high);
  } while (holds(fails));
  while (fails > low * (1 + share)) {
    const double middle = std::sqrt(low * fails);
    (holds(middle) ? low : fails) = middle;
  }
  return low;
}

CaseVerdict case_verdict(const StabilityCase& tried, const RunSettings& settings,
                         const Contender& contender, int max_seeds) {
  std::vector<Verdict> verdicts(static_cast<std::size_t>(seeds_of(tried, max_seeds)));
  tbb::parallel_for(std::size_t{0}, verdicts.size(), [&](std::size_t i) {
    verdicts[i] = run_and_judge(tried, with_seed(settings, static_cast<int>(i)), contender).verdict;
  });
  return gathered(verdicts, settings.seed);
}

bool all_good(const StabilityCase& tried, const RunSettings& settings, const Contender& contender,
              int max_seeds) {
  for (int i = 0; i < seeds_of(tried, max_seeds); ++i) {
    if (!run_and_judge(tried, with_seed(settings, i), contender).verdict.good) return false;
  }
  return true;
}

double case_border(const StabilityCase& tried, const RunSettings& settings,
                   const Contender& contender, double low, double high, double share,
                   int max_seeds) {
  const auto is_good = [&](double stiffness) {
    RunSettings at = settings;
    at.stiffness = stiffness;
    return all_good(tried, at, contender, max_seeds);
  };
  return stiffest(is_good, low, high, share);
}

}  // namespace spm::stability
