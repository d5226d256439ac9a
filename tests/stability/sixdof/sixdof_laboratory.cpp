// SPDX-License-Identifier: GPL-3.0-or-later
#include "tests/stability/sixdof/sixdof_laboratory.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>
#include <optional>

#include "common/base/hand_pose.hpp"
#include "common/base/random.hpp"
#include "common/base/units.hpp"
#include "servo/devices/sim/sim_plant.hpp"
#include "tests/stability/sixdof/sixdof_handover.hpp"

namespace spm::stability {

namespace {

constexpr double gravity = 9.81;  // m/s2
/// The drawn tool is compared with the exact object once in this many ticks.
constexpr std::size_t looked_at = 10;

/// What the judges of three degrees of freedom need to know of a case.
StabilityCase judged_case(const SixdofCase& tried) {
  StabilityCase made;
  made.name = tried.name;
  made.normal = tried.normal;
  made.judged = tried.judged;
  // One height cannot tell how deep a turning tool lies: judge_sixdof checks the depth.
  made.judged.longest_penetration = std::numeric_limits<double>::infinity();
  return made;
}

JudgedLoop loop_of(const SixdofCase& tried, const RunSettings& settings) {
  const SixdofSettings plant = sixdof_settings(tried, settings);
  JudgedLoop loop;
  loop.stiffness = settings.stiffness;
  loop.delay = tried.delay_ticks;
  loop.lag = 1 / (2 * std::numbers::pi * plant.profile.bandwidth);
  loop.encoder_step = plant.profile.encoder_step;
  loop.force_cap = plant.profile.force_cap;
  const double grip = tried.grip_share * servo::grip_stiffness;
  loop.hand_stiffness = grip * servo::arm_stiffness / (grip + servo::arm_stiffness);
  // Friction carries a part of the pressing force, and the weight adds to the force.
  loop.friction = plant.profile.friction + plant.weight.dot(tried.normal);
  return loop;
}

/// The same for the turn, as lengths and forces at the lever.
JudgedLoop turning_loop_of(const SixdofCase& tried, const RunSettings& settings) {
  const SixdofPlant plant(sixdof_settings(tried, settings));
  JudgedLoop loop = loop_of(tried, settings);
  loop.encoder_step = plant.turn_step() * sixdof_lever;
  loop.force_cap = plant.torque_cap() / sixdof_lever;
  loop.hand_stiffness = 0;
  loop.friction = 0;
  return loop;
}

/// Records a tick's state before the plant steps through it.
class TickReader {
 public:
  TickReader(const SixdofPlant& plant, const Eigen::Isometry3d& start)
      : plant_(plant), start_(start.linear()) {}

  [[nodiscard]] TraceTick place(double time, const SixdofTarget& target,
                                const Eigen::Isometry3d& measured,
                                const SixdofAnswer& answer) const {
    TraceTick tick = begun(time, answer);
    tick.target = target.position;
    tick.position = plant_.pose().translation();
    tick.velocity = plant_.velocity();
    tick.measured = measured.translation();
    tick.commanded = plant_.reachable(answer.wrench).force;
    return tick;
  }

  /// Turns since the start and torques, as lengths and forces at the lever.
  [[nodiscard]] TraceTick turn(double time, const SixdofTarget& target,
                               const Eigen::Isometry3d& measured,
                               const SixdofAnswer& answer) const {
    TraceTick tick = begun(time, answer);
    tick.target = turned(target.orientation);
    tick.position = turned(Eigen::Quaterniond(plant_.pose().linear()));
    tick.velocity = sixdof_lever * plant_.angular_velocity();
    tick.measured = turned(Eigen::Quaterniond(measured.linear()));
    tick.commanded = plant_.reachable(answer.wrench).torque / sixdof_lever;
    return tick;
  }

 private:
  [[nodiscard]] static TraceTick begun(double time, const SixdofAnswer& answer) {
    TraceTick tick;
    tick.time = time;
    tick.depth = answer.depth;
    tick.contact = answer.contact;
    return tick;
  }
  [[nodiscard]] Vector3 turned(const Eigen::Quaterniond& orientation) const {
    return sixdof_lever * turn_between(start_, orientation);
  }

  const SixdofPlant& plant_;
  Eigen::Quaterniond start_;
};

/// How far a drawn tool is from where it lay at a time.
class Stillness {
 public:
  explicit Stillness(const Creep& creep) : from_(creep.from) {}

  void look(double now, const Eigen::Isometry3d& drawn) {
    if (!(from_ > 0) || now < from_) return;
    const Eigen::Quaterniond orientation(drawn.linear());
    if (!lay_) lay_ = HandPose{drawn.translation(), orientation};
    most_.place = std::max(most_.place, (drawn.translation() - lay_->position).norm());
    most_.turn = std::max(most_.turn, turn_between(lay_->orientation, orientation).norm());
  }
  [[nodiscard]] const Creep& most() const noexcept { return most_; }

 private:
  double from_;
  std::optional<HandPose> lay_;
  Creep most_;
};

/// Fails a run whose drawn tool moved where it was to lie still; twice the limit is bad.
void judge_creep(const Creep& allowed, const Creep& crept, Verdict& verdict) {
  if (!(allowed.from > 0)) return;
  const double times = std::max(crept.place / allowed.place, crept.turn / allowed.turn);
  if (!(times > 1)) return;
  verdict.good = false;
  verdict.bad = verdict.bad || times > 2;
  if (!verdict.reason.empty()) verdict.reason += "; ";
  verdict.reason += "the drawn tool creeps by " + format_quantity(crept.place, Quantity::length) +
                    " and turns by " + format_quantity(crept.turn, Quantity::angle);
}

/// Joins the verdicts on two parts of one run.
void join(Verdict& verdict, const Verdict& turning) {
  verdict.good = verdict.good && turning.good;
  verdict.bad = verdict.bad || turning.bad;
  if (!turning.reason.empty()) {
    if (!verdict.reason.empty()) verdict.reason += "; ";
    verdict.reason += "turning: ";
    verdict.reason += turning.reason;
  }
  Findings& found = verdict.findings;
  found.ripple_n = std::max(found.ripple_n, turning.findings.ripple_n);
  found.ripple_m = std::max(found.ripple_m, turning.findings.ripple_m);
  found.settled_s = std::max(found.settled_s, turning.findings.settled_s);
  found.generated_bound_j += turning.findings.generated_bound_j;
}

/// A run of a seed, judged.
Verdict verdict_of(const SixdofCase& tried, const SixdofScene& scene, const RunSettings& settings,
                   const Contender& contender) {
  if (!tried.two_hands) return run_sixdof_case(tried, scene, settings, contender).verdict;
  return judge_handover(tried, hand_over(tried, scene, settings, contender));
}

}  // namespace

Vector3 offset_of(Random& random) {
  Vector3 offset;
  for (double& along : offset) along = random.between(-0.5, 0.5);
  return offset;
}

SixdofSettings sixdof_settings(const SixdofCase& tried, const RunSettings& settings) {
  SixdofSettings plant;
  plant.profile = *settings.profile;
  plant.profile.damping += settings.damping;
  plant.period = settings.period;
  plant.substeps = servo::substeps_for(settings.period);
  plant.mass_scale = tried.mass_scale;
  plant.delay_ticks = tried.delay_ticks;
  plant.grip_share = tried.grip_share;
  if (!settings.torque) plant.torque_lever = 0;
  if (tried.has_weight) {
    plant.weight.z() = -gravity * settings.profile->mass * (tried.mass_scale - 1);
  }
  return plant;
}

SixdofRun run_sixdof_case(const SixdofCase& tried, const SixdofScene& scene,
                          const RunSettings& settings, const Contender& contender) {
  SixdofPlant plant(sixdof_settings(tried, settings));
  Random random(settings.seed);
  const Vector3 offset = offset_of(random) * settings.profile->encoder_step;
  Eigen::Isometry3d start = tried.start;
  start.pretranslate(offset);
  start.linear() =
      orientation_of(offset_of(random) * plant.turn_step()).toRotationMatrix() * start.linear();
  const SixdofScript script(tried, settings.period, offset);
  const auto contestant = make_sixdof_contestant(contender, scene, tried, settings);
  const auto exact = scene.exact_fields();
  plant.place(start);
  contestant->begin(start);
  const TickReader reader(plant, start);
  SixdofRun run;
  Stillness still(tried.creep);
  run.trace.period = run.turning.period = settings.period;
  double deepest = 0;
  const auto ticks = static_cast<std::size_t>(std::lround(tried.seconds / settings.period));
  for (std::size_t i = 0; i < ticks; ++i) {
    const double now = static_cast<double>(i) * settings.period;
    const Eigen::Isometry3d measured = plant.measured_pose();
    const SixdofAnswer answer = contestant->next(measured);
    TraceTick place = reader.place(now, script.at(now), measured, answer);
    TraceTick turn = reader.turn(now, script.at(now), measured, answer);
    const SixdofTick done = plant.step(answer.wrench, script.at(now + settings.period));
    place.hand_force = done.hand.force;
    place.work = done.work;
    turn.hand_force = done.hand.torque / sixdof_lever;
    run.trace.ticks.push_back(place);
    run.turning.ticks.push_back(turn);
    still.look(now, answer.drawn);
    if (i % looked_at == 0) {
      deepest = std::max(deepest, scene.contact(exact, answer.drawn, 1).deepest);
    }
  }
  run.crept = still.most();
  run.verdict = judge_sixdof(tried, settings, run, deepest);
  return run;
}

Verdict judge_sixdof(const SixdofCase& tried, const RunSettings& settings, const SixdofRun& run,
                     double deepest) {
  StabilityCase judged = judged_case(tried);
  Verdict verdict = judge(judged, loop_of(tried, settings), run.trace);
  judged.judged.pop = judged.judged.energy = false;
  join(verdict, judge(judged, turning_loop_of(tried, settings), run.turning));
  Findings& found = verdict.findings;
  found.penetration_m = deepest;
  if (deepest > tried.judged.longest_penetration) {
    verdict.good = false;
    verdict.bad = true;
    if (!verdict.reason.empty()) verdict.reason += "; ";
    verdict.reason += "the drawn tool lies " + format_quantity(deepest, Quantity::length) + " deep";
  }
  judge_creep(tried.creep, run.crept, verdict);
  verdict.within_energy = !tried.judged.energy || found.generated_j <= found.generated_bound_j;
  return verdict;
}

CaseVerdict sixdof_verdict(const SixdofCase& tried, const SixdofScene& scene,
                           const RunSettings& settings, const Contender& contender, int max_seeds) {
  std::vector<Verdict> verdicts;
  RunSettings seeded = settings;
  for (int i = 0; i < std::max(1, std::min(tried.seeds, max_seeds)); ++i, ++seeded.seed) {
    verdicts.push_back(verdict_of(tried, scene, seeded, contender));
  }
  return gathered(verdicts, settings.seed);
}

double sixdof_border(const SixdofCase& tried, const SixdofScene& scene, const RunSettings& settings,
                     const Contender& contender, double low, double high, double share,
                     int max_seeds) {
  const auto is_good = [&](double stiffness) {
    RunSettings at = settings;
    at.stiffness = stiffness;
    for (int i = 0; i < std::max(1, std::min(tried.seeds, max_seeds)); ++i, ++at.seed) {
      if (!verdict_of(tried, scene, at, contender).good) return false;
    }
    return true;
  };
  return stiffest(is_good, low, high, share);
}

}  // namespace spm::stability
