// SPDX-License-Identifier: Apache-2.0
#include "servo/devices/sim/hand_planner.hpp"

#include <algorithm>
#include <cmath>
#include <utility>

#include "servo/devices/sim/surface_walk.hpp"

namespace spm::servo {

namespace {

constexpr int lines_tried = 512;
constexpr int plans_wanted = 24;
constexpr double good_share = 0.9;    // of the worst second
constexpr double longest_walk = 0.2;  // m
constexpr std::size_t longest_trial = 12000;

/// A slide that gets stuck before this length shows little; its score is reduced by the penalty.
constexpr double shortest_walk = 0.02;  // m
constexpr double stuck_penalty = 0.2;

/// A hand that wants to go deeper than this fraction of a wall's thickness is pushed out on the
/// other side.
constexpr double share_of_thickness = 0.35;

/// The thickness to look for, in depths: a full press fits in it.
constexpr double thickness_in_depths = 1 / share_of_thickness;

/// To which depth the places must be firm, as a fraction of the full depth, in each round of the
/// search. Good places come first.
constexpr double rounds[] = {1, 0.5, 0.25, 0.1, 0.05, 0};

/// One over the cosine, of surface and probe, at which a probe stands wholly on one of its ends.
constexpr double turning_over = 4;

struct Plan {
  PoseMotion motion;
  double score = -1;  ///< contact in the worst second, 0 to 1, less a penalty
};

/// An object as the hand reaches it: its asset, and the transformation between its frame and the
/// hand's.
struct Reached {
  const AssetView& asset;
  Placement object, hand;
  double probe_radius, depth;  ///< m, asset's frame
  Vector3 half_axis;           ///< of a probe with a long side, m, asset's frame

  Reached(std::span<const AssetView* const> assets, const HandTask& task, std::size_t which)
      : asset(*assets[task.scene.objects[which].asset]),
        object(task.scene.objects[which].placement),
        hand(task.scene.workspace),
        probe_radius(task.scene.objects[which].force.probe_radius / object.scale),
        depth(task.depth * hand.scale / object.scale) {
    const ForceSettings& force = task.scene.objects[which].force;
    half_axis = force.probe_length / 2 / object.scale *
                (object.rotation.conjugate() * (hand.rotation * force.probe_axis));
  }

  /// Where the hand is when the end of its probe that is closer to the surface is at a point. That
  /// goes over to the other end where the surface lies along the probe.
  [[nodiscard]] Vector3 in_hand(const Vector3& point, const Vector3& normal) const {
    const double size = half_axis.norm();
    const double side = size > 0 ? half_axis.dot(normal) / size : 0;
    const Vector3 middle = point + std::clamp(turning_over * side, -1.0, 1.0) * half_axis;
    return hand.from_world(object.to_world(middle));
  }
};

/// The hand's target below a touched place.
Vector3 target_below(const Reached& reached, const Touch& touch) {
  const double limit = thickness_in_depths * reached.depth;
  const double thickness = thickness_below(reached.asset, reached.probe_radius, touch, limit);
  const double depth = std::min(reached.depth, share_of_thickness * thickness);
  return reached.in_hand(touch.centre - depth * touch.normal, touch.normal);
}

PoseMotion motion_from(const Reached& reached, const HandTask& task, const Touch& start,
                       double firm_depth, Random& random) {
  const Vector3 approach =
      reached.in_hand(start.centre + reached.depth * start.normal, start.normal);
  if (!task.slide) {
    return PoseMotion::press({unturned(approach), unturned(target_below(reached, start))},
                             {task.speed, fastest_turn}, task.plant.period);
  }
  WalkSettings settings;
  settings.probe_radius = reached.probe_radius;
  settings.length = longest_walk;
  settings.firm_depth = firm_depth;
  std::vector<HandPose> poses{unturned(approach)};
  for (const Touch& touch : walk(reached.asset, settings, start, random)) {
    poses.push_back(unturned(target_below(reached, touch)));
  }
  return PoseMotion::back_and_forth(std::move(poses), 1, {task.speed, fastest_turn},
                                    task.plant.period);
}

/// The score of a motion for a task.
double score_of(std::span<const AssetView* const> assets, const HandTask& task,
                const PoseMotion& motion) {
  const std::size_t ticks = std::min(motion.cycle_ticks(), longest_trial);
  const double share = contact_share(assets, task, motion, ticks);
  const bool stuck =
      task.slide && static_cast<double>(motion.cycle_ticks()) * task.plant.period * task.speed <
                        2 * shortest_walk;
  return share - (stuck ? stuck_penalty : 0);
}

/// Plans on one object, until a plan is good. `best` is the best of all plans so far.
void plan_on(std::span<const AssetView* const> assets, const HandTask& task, std::size_t which,
             Random& random, Plan& best) {
  const Reached reached(assets, task, which);
  for (const double firm : rounds) {
    int plans = 0;
    for (int line = 0; line < lines_tried && plans < plans_wanted; ++line) {
      const auto touch = touch_from_outside(reached.asset, reached.probe_radius, random);
      if (!touch) continue;
      const double firm_depth = firm * reached.depth;
      if (!firm_below(reached.asset, reached.probe_radius, *touch, firm_depth)) continue;
      ++plans;
      PoseMotion motion = motion_from(reached, task, *touch, firm_depth, random);
      const double score = score_of(assets, task, motion);
      if (score > best.score) best = {std::move(motion), score};
      if (best.score >= good_share) return;
    }
  }
}

}  // namespace

double contact_share(std::span<const AssetView* const> assets, const HandTask& task,
                     PoseMotion motion, std::size_t ticks) {
  SimPlant tool(task.plant);
  tool.place(motion.start().position);
  const auto second = static_cast<std::size_t>(std::ceil(1 / task.plant.period));
  SceneForce force(task.scene, task.plant.period, task.plant.profile.encoder_step);
  double worst = 1;
  for (std::size_t begin = 0; begin < ticks; begin += second) {
    std::size_t touching = 0;
    for (std::size_t tick = 0; tick < second; ++tick) {
      const ContactForce contact = force.next(assets, tool.measured_position());
      touching += contact.contact ? 1 : 0;
      const SixdofTarget target = motion.next();
      tool.step(contact.force, {target.position, target.velocity});
    }
    worst = std::min(worst, static_cast<double>(touching) / static_cast<double>(second));
  }
  return worst;
}

Result<PoseMotion> plan_hand(std::span<const AssetView* const> assets, const HandTask& task) {
  Random random(task.seed);
  Plan best;
  for (std::size_t i = 0; i < task.scene.objects.size() && best.score < good_share; ++i) {
    plan_on(assets, task, i, random, best);
  }
  if (best.score < -stuck_penalty) {
    return fail(
        ExitCode::invalid_input,
        "device sim: the asset shows no surface for the hand to touch; bake it again with a "
        "larger --margin, or give the hand its way with sim:hand=path,path=FILE");
  }
  return best.motion;
}

}  // namespace spm::servo
