// SPDX-License-Identifier: GPL-3.0-or-later
#include "tests/stability/sixdof/sixdof_handover.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <memory>
#include <span>
#include <string>
#include <utility>
#include <vector>

#include "common/base/random.hpp"
#include "common/base/units.hpp"
#include "servo/force/sampled_tool.hpp"
#include "servo/force/scene_force.hpp"
#include "tests/bench/base/unwrap.hpp"
#include "tests/stability/sixdof/sixdof_contestant.hpp"
#include "tests/stability/sixdof/sixdof_laboratory.hpp"

namespace spm::stability {

namespace {

constexpr double box_edge = 20e-3;         // m, edge of the object
constexpr double box_mass = 0.15;          // kg
constexpr double box_braking = 4;          // N s/m
constexpr double box_turn_braking = 2e-3;  // N m s/rad
const Vector3 tool_size(4e-3, 12e-3, 12e-3);
const double touch = (box_edge + tool_size.x()) / 2;  // m, of a tool at the object's middle
constexpr double watched_seconds = 0.3;               // s, at the end of each press
constexpr std::size_t look_ticks = 10;  // ticks, after which drawn tools are compared again
constexpr double aside = 3e-3;          // m, of the middle, each hand to another side
constexpr double least_held = 0.3;      // N, where hands press
constexpr double least_way = 5e-3;      // m, that each hand takes the object

/// A place of a hand's target at a time, between which it goes straight.
struct Stop {
  double time;      ///< s
  double along, y;  ///< m
};

/// The first hand pushes the object to the second, presses, leaves, goes round and presses the
/// second's tool from behind.
const std::vector<Stop> first_way{{0.2, -touch - 10e-3, 0},     {1.2, -touch + 25e-3, 0},
                                  {2.2, -touch + 25e-3, 0},     {2.7, -touch - 30e-3, 0},
                                  {3.1, -touch - 30e-3, 40e-3}, {3.6, touch + 20e-3, 40e-3},
                                  {4.0, touch + 20e-3, 0},      {4.6, touch - 16e-3, 0}};
/// The second waits where the object is brought to, and pushes it back once it is alone.
const std::vector<Stop> second_way{{2.7, touch + 15e-3, 0}, {3.3, touch - 4e-3, 0}};
constexpr double both_until = 2.2, alone_until = 3.9, handover_seconds = 5.4;  // s

Vector3 wanted(const std::vector<Stop>& way, double time) {
  const auto next =
      std::find_if(way.begin(), way.end(), [time](const Stop& stop) { return stop.time > time; });
  if (next == way.begin()) return {way.front().along, way.front().y, 0};
  if (next == way.end()) return {way.back().along, way.back().y, 0};
  const Stop& from = *(next - 1);
  const double share = (time - from.time) / (next->time - from.time);
  return {from.along + share * (next->along - from.along), from.y + share * (next->y - from.y), 0};
}

/// The tool as the other hand's tool touches it: baked, as an object.
const AssetView& touched_tool() {
  StabilityCase made;
  made.name = "handing-tool";
  made.shape = test::box(tool_size);
  made.tolerance = 20e-6;
  made.max_depth = 1.5e-3;
  return prepared_object(made).sparse();
}

/// A hand with its device and its forces.
class Hand {
 public:
  Hand(const SixdofCase& tried, const SixdofScene& scene, const ForceScene& forces,
       const RunSettings& settings, std::size_t number, const Vector3& offset)
      : way_(number == 0 ? first_way : second_way),
        offset_(offset + Vector3(0, number == 0 ? -aside : aside, 0)),
        period_(settings.period),
        plant_(sixdof_settings(tried, settings)),
        assets_{&scene.object().sparse(), &touched_tool()},
        tool_(bench::unwrap(SampledTool::make(touched_tool(), *tool_of(forces, number), 1,
                                              objects_to_meet(forces, 0)))),
        force_(forces, settings.period, settings.profile->encoder_step, 0, {},
               turning_of(tried, settings), number) {
    force_.take_tool(tool_.get(), 0);
    plant_.place(pose_of(target(0).position));
  }

  [[nodiscard]] SceneForce& force() { return force_; }

  /// A tick with the object at a pose; what the tool does to the object.
  Wrench tick(double time, const Eigen::Isometry3d& object) {
    const Eigen::Isometry3d measured = plant_.measured_pose();
    force_.place(0, object.translation(), Eigen::Quaterniond(object.linear()).normalized());
    const HandPose hand{measured.translation(), Eigen::Quaterniond(measured.linear()).normalized()};
    const ContactForce felt = force_.next(assets_, hand);
    const Wrench sent = plant_.reachable({felt.force, felt.torque});
    force_.sent(sent);
    forces_.push_back(sent.force);
    plant_.step(sent, target(time + period_));
    return force_.reaction(0);
  }

  [[nodiscard]] const Eigen::Isometry3d& drawn() const { return force_.tool().pose; }
  /// N, mean of the force along x over the watched time before a moment.
  [[nodiscard]] double mean(double until) const { return mean_of(watched(until)).x(); }
  /// N RMS of the force over the same time, its mean removed.
  [[nodiscard]] double ripple(double until) const {
    const auto forces = watched(until);
    const Vector3 mean = mean_of(forces);
    double squares = 0;
    for (const Vector3& force : forces) squares += (force - mean).squaredNorm();
    return std::sqrt(squares / static_cast<double>(forces.size()));
  }

 private:
  [[nodiscard]] std::span<const Vector3> watched(double until) const {
    const auto end = static_cast<std::size_t>(std::lround(until / period_));
    const auto count = static_cast<std::size_t>(std::lround(watched_seconds / period_));
    return std::span(forces_).subspan(end - count, count);
  }
  [[nodiscard]] static Vector3 mean_of(std::span<const Vector3> forces) {
    Vector3 sum = Vector3::Zero();
    for (const Vector3& force : forces) sum += force;
    return sum / static_cast<double>(forces.size());
  }
  [[nodiscard]] SixdofTarget target(double time) const {
    SixdofTarget target;
    target.position = offset_ + wanted(way_, time);
    target.velocity = (offset_ + wanted(way_, time + period_) - target.position) / period_;
    return target;
  }

  const std::vector<Stop>& way_;
  Vector3 offset_;
  double period_;
  SixdofPlant plant_;
  std::array<const AssetView*, 2> assets_;
  std::unique_ptr<SampledTool> tool_;
  SceneForce force_;
  std::vector<Vector3> forces_;
};

/// A free box in a medium, moved by wrenches that hold over a tick; its dampers are implicit.
class FreeBox {
 public:
  void step(const Wrench& wrench, double period) {
    velocity_ = (box_mass * velocity_ + period * wrench.force) / (box_mass + period * box_braking);
    const double inertia = box_mass * box_edge * box_edge / 6;
    rate_ = (inertia * rate_ + period * wrench.torque) / (inertia + period * box_turn_braking);
    pose_.translation() += period * velocity_;
    orientation_ = (orientation_of(period * rate_) * orientation_).normalized();
    pose_.linear() = orientation_.toRotationMatrix();
  }
  [[nodiscard]] const Eigen::Isometry3d& pose() const { return pose_; }
  [[nodiscard]] double turned() const {
    return turn_between(Eigen::Quaterniond::Identity(), orientation_).norm();
  }

 private:
  Eigen::Isometry3d pose_ = Eigen::Isometry3d::Identity();
  Eigen::Quaterniond orientation_ = Eigen::Quaterniond::Identity();
  Vector3 velocity_ = Vector3::Zero(), rate_ = Vector3::Zero();
};

/// Adds what a run fails by; the sentence is put together where it fails.
void fail(Verdict& verdict, bool bad, const std::string& reason) {
  verdict.good = false;
  verdict.bad = verdict.bad || bad;
  if (!verdict.reason.empty()) verdict.reason += "; ";
  verdict.reason += reason;
}

}  // namespace

SixdofCase handed_case() {
  SixdofCase made;
  made.name = "object-handed-over";
  made.title =
      "Two hands hand over an object that moves by what both do to it, and press tool on tool";
  made.tool = test::box(tool_size);
  made.object = test::box({box_edge, box_edge, box_edge});
  made.places = {Eigen::Isometry3d::Identity()};
  made.start = pose_of({-touch - 10e-3, 0, 0});
  made.seconds = handover_seconds;
  made.touch = pose_of({-touch, 0, 0});
  made.press = Vector3::UnitX();
  made.normal = -Vector3::UnitX();
  made.judged.longest_penetration = 0.5e-3;
  made.two_hands = true;
  return made;
}

HandoverRun hand_over(const SixdofCase& tried, const SixdofScene& scene,
                      const RunSettings& settings, const Contender& contender) {
  ForceScene forces = served_scene(contender, scene, tried, settings);
  forces.more_tools = {*forces.tool};
  Random random(settings.seed);
  const Vector3 one = offset_of(random) * settings.profile->encoder_step;
  const Vector3 other = offset_of(random) * settings.profile->encoder_step;
  Hand first(tried, scene, forces, settings, 0, one);
  Hand second(tried, scene, forces, settings, 1, other);
  const std::array<SceneForce*, 2> meeting{&first.force(), &second.force()};
  for (SceneForce* force : meeting) force->meet(meeting);
  const auto exact = scene.exact_fields();
  FreeBox object;
  HandoverRun run;
  const auto ticks = static_cast<std::size_t>(std::lround(handover_seconds / settings.period));
  for (std::size_t i = 0; i < ticks; ++i) {
    const double now = static_cast<double>(i) * settings.period;
    const Wrench a = first.tick(now, object.pose()), b = second.tick(now, object.pose());
    object.step({a.force + b.force, a.torque + b.torque}, settings.period);
    run.turned = std::max(run.turned, object.turned());
    if (now < both_until) run.brought = object.pose().translation().x();
    if (now < alone_until) {
      run.taken = run.brought - object.pose().translation().x();
    } else {
      const Vector3 apart = first.drawn().translation() - second.drawn().translation();
      run.overlap = std::max(run.overlap, tool_size.x() - apart.x());
    }
    if (i % look_ticks != 0) continue;
    for (const Hand* hand : {&first, &second}) {
      const Eigen::Isometry3d drawn = object.pose().inverse(Eigen::Isometry) * hand->drawn();
      run.deepest = std::max(run.deepest, scene.contact(exact, drawn, 1).deepest);
    }
  }
  run.held = second.mean(both_until);
  run.met = first.mean(handover_seconds);
  run.differs = std::abs(first.mean(handover_seconds) + second.mean(handover_seconds));
  run.ripple =
      std::max({first.ripple(both_until), second.ripple(both_until), second.ripple(alone_until),
                first.ripple(handover_seconds), second.ripple(handover_seconds)});
  return run;
}

Verdict judge_handover(const SixdofCase& tried, const HandoverRun& run) {
  const auto length = [](double value) { return format_quantity(value, Quantity::length); };
  const auto force = [](double value) { return format_quantity(value, Quantity::force); };
  Verdict verdict;
  Findings& found = verdict.findings;
  found.ripple_n = run.ripple;
  found.penetration_m = std::max(run.deepest, run.overlap);
  found.held_n = std::min(run.held, run.met);
  found.popped = !(run.held > least_held) || !(run.met > least_held);
  if (!(run.ripple < good_ripple)) {
    fail(verdict, !(run.ripple <= bad_ripple), "ripple of " + force(run.ripple) + " RMS");
  }
  if (found.popped) fail(verdict, true, "popped through: " + force(found.held_n) + " held");
  if (!(run.brought > least_way) || !(run.taken > least_way)) {
    fail(verdict, true,
         "the object was brought " + length(run.brought) + " and taken " + length(run.taken));
  }
  if (!(found.penetration_m <= tried.judged.longest_penetration)) {
    fail(verdict, true, "a drawn tool lies " + length(found.penetration_m) + " deep");
  }
  return verdict;
}

}  // namespace spm::stability
