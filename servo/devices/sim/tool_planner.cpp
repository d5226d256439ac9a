// SPDX-License-Identifier: Apache-2.0
#include "servo/devices/sim/tool_planner.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <memory>
#include <optional>
#include <utility>
#include <vector>

#include "servo/devices/sim/surface_walk.hpp"
#include "servo/force/paper_tool.hpp"

namespace spm::servo {

namespace {

constexpr int lines_tried = 256;
constexpr int plans_wanted = 6;                // in each round
constexpr double good_share = 0.9;             // of the worst second
constexpr double longest_walk = 0.1;           // m
constexpr std::size_t longest_trial = 6000;    // ticks
constexpr std::size_t planned_samples = 600;   // the plan needs no more of the tool
constexpr std::uint32_t planned_cells = 2048;  // of a `full` tool's maps, in a tick
constexpr double share_of_thickness = 0.35;    // as the hand's planner for a point

/// How far the tool is turned from how the hand holds it at rest, at a place and while it slides.
constexpr double largest_lean = 0.35, lean_while_sliding = 0.15, swing = 0.3;  // rad
constexpr double swing_length = 0.03;                                          // m, of one swing
constexpr double turn_speed = 1;                                               // rad/s

/// To which depth the places must be firm, as a fraction of the full depth, in each round.
constexpr double rounds[] = {1, 0.25, 0};

/// A scene as the planner sees it: the tool's places, and the frames of hand, tool and object.
class Reach {
 public:
  Reach(std::span<const AssetView* const> assets, const ToolTask& task, const SampledTool& tool,
        std::size_t which)
      : asset(*assets[task.scene.objects[which].asset]),
        object_(task.scene.objects[which].placement),
        hand_(task.scene.workspace),
        turns_(task.turning.reads) {
    depth = task.depth * hand_.scale / object_.scale;
    if (tool.paper() != nullptr) {
      for (const Vector3& place : outermost_places(*tool.paper(), planned_samples)) {
        places_.push_back(task.scene.tool->placement.to_world(place));
      }
      if (places_.empty()) places_.push_back(task.scene.tool->placement.position);
      return;
    }
    const SampleLevel& finest = tool.samples().levels.back();
    for (std::uint32_t i = 0; i < finest.count; ++i) {
      const auto& place = tool.samples().places[finest.first + i].position;
      places_.emplace_back(place[0], place[1], place[2]);
    }
  }

  /// The hand's orientation after a turn (axis times angle, world frame) from how it is at rest.
  [[nodiscard]] Eigen::Quaterniond turned(const Vector3& turn) const {
    if (!turns_) return Eigen::Quaterniond::Identity();
    return (hand_.rotation.conjugate() * orientation_of(turn) * hand_.rotation).normalized();
  }

  /// The pose of the hand, so oriented, in which the tool reaches just as deep (m of the asset)
  /// below a touched place, with the place of the tool that lies deepest that way.
  [[nodiscard]] HandPose below(const Touch& touch, double deep,
                               const Eigen::Quaterniond& orientation) const {
    const Vector3 normal = object_.rotation * touch.normal;
    const Eigen::Quaterniond to_world = hand_.rotation * orientation;
    const Vector3 wanted = to_world.conjugate() * normal;
    const Vector3* lowest = &places_.front();
    for (const Vector3& place : places_) {
      if (place.dot(wanted) < lowest->dot(wanted)) lowest = &place;
    }
    const Vector3 at = object_.to_world(touch.centre) - deep * object_.scale * normal;
    return {hand_.from_world(at - to_world * *lowest), orientation};
  }

  /// How deep to press at a place, m of the asset.
  [[nodiscard]] double pressed(const Touch& touch) const {
    const double thickness = thickness_below(asset, 0, touch, depth / share_of_thickness);
    return std::min(depth, share_of_thickness * thickness);
  }

  const AssetView& asset;
  double depth = 0;  ///< m, asset's frame

 private:
  Placement object_, hand_;
  bool turns_;
  std::vector<Vector3> places_;  ///< of the tool, m of the world, the device's tool's frame
};

PoseMotion motion_from(const Reach& reach, const ToolTask& task, const Touch& start,
                       double firm_depth, double longest, Random& random) {
  const Vector3 lean = random.between(0, largest_lean) * random.direction();
  const PoseSpeed speed{task.speed, turn_speed};
  const HandPose approach = reach.below(start, -2 * reach.depth, reach.turned(lean));
  std::vector<HandPose> poses{approach};
  if (!task.slide) {
    poses.push_back(reach.below(start, reach.pressed(start), reach.turned(lean)));
    const Vector3 about = swing * start.normal;
    poses.push_back(reach.below(start, reach.pressed(start), reach.turned(lean + about)));
    return PoseMotion::press(std::move(poses), speed, task.plant.period);
  }
  WalkSettings settings;
  settings.length = longest;
  settings.firm_depth = firm_depth;
  const double per_stride = 2 * std::numbers::pi * settings.stride / swing_length;
  double phase = 0;
  for (const Touch& touch : walk(reach.asset, settings, start, random)) {
    const Vector3 about = swing * std::sin(phase) * touch.normal;
    const Vector3 aside =
        lean_while_sliding * std::sin(0.7 * phase) * touch.normal.unitOrthogonal();
    poses.push_back(reach.below(touch, reach.pressed(touch), reach.turned(lean + about + aside)));
    phase += per_stride;
  }
  return PoseMotion::back_and_forth(std::move(poses), 1, speed, task.plant.period);
}

/// Where a plan of a round begins, and how far it goes from there. By the paper's equations a tool
/// is felt through the planes along the line between the middles of both: one of many small maps
/// touches only where that line meets the surface straight, and not far from there.
struct Trial {
  bool aimed = false;  ///< at the object's middle, along a support plane's normal
  double longest = longest_walk;
};

Trial trial_of(const SampledTool& tool, int plan) {
  if (tool.paper() == nullptr || plan < 2) return {};
  constexpr double shorter = 7;  // 0.3 mm in the last plan of a round
  return {true, longest_walk * std::pow(shorter, 2 - plan)};
}

std::optional<Touch> touch_of(const AssetView& asset, const Trial& trial, Random& random) {
  if (!trial.aimed || asset.planes.empty()) return touch_from_outside(asset, 0, random);
  const auto [low, size] = extent_of(asset);
  const auto plane = static_cast<std::size_t>(random.between(0, double(asset.planes.size())));
  return touch_along(asset, 0, low + size / 2,
                     -asset.planes[std::min(plane, asset.planes.size() - 1)].n);
}

/// Plans on one object, until a plan is good. `best` is the best of all plans so far.
void plan_on(std::span<const AssetView* const> assets, const ToolTask& task, SampledTool& tool,
             std::size_t which, Random& random, PlannedMotion& best) {
  const Reach reach(assets, task, tool, which);
  for (const double firm : rounds) {
    int plans = 0;
    for (int line = 0; line < lines_tried && plans < plans_wanted; ++line) {
      const Trial trial = trial_of(tool, plans);
      const auto touch = touch_of(reach.asset, trial, random);
      if (!touch) continue;
      const double firm_depth = firm * reach.depth;
      if (!firm_below(reach.asset, 0, *touch, firm_depth)) continue;
      ++plans;
      PoseMotion motion = motion_from(reach, task, *touch, firm_depth, trial.longest, random);
      const double score = contact_share(
          assets, task, tool, motion, std::min(motion.cycle_ticks(), longest_trial), best.touching);
      if (score > best.touching) best = {std::move(motion), score};
      if (best.touching >= good_share) return;
    }
  }
}

}  // namespace

double contact_share(std::span<const AssetView* const> assets, const ToolTask& task,
                     SampledTool& tool, PoseMotion motion, std::size_t ticks, double beaten) {
  SixdofPlant plant(task.plant);
  Eigen::Isometry3d start = Eigen::Isometry3d::Identity();
  start.translation() = motion.start().position;
  start.linear() = motion.start().orientation.toRotationMatrix();
  plant.place(start);
  const double period = task.plant.period;
  SceneForce force(task.scene, period, task.plant.profile.encoder_step, 0, {}, task.turning);
  force.take_tool(&tool, 0);
  ForceBudget budget;
  if (tool.paper() != nullptr) budget.worked = planned_cells;
  const auto second = static_cast<std::size_t>(std::ceil(1 / period));
  // The first second brings the tool to the surface.
  const std::size_t approach = second / 2;
  const auto share = [second](std::size_t touching) {
    return static_cast<double>(touching) / static_cast<double>(second);
  };
  double worst = 1;
  for (std::size_t begin = 0; begin < ticks; begin += second) {
    std::size_t touching = second;
    for (std::size_t tick = 0; tick < second; ++tick) {
      const Eigen::Isometry3d measured = plant.measured_pose();
      const HandPose hand{measured.translation(), Eigen::Quaterniond(measured.linear())};
      const ContactForce contact = force.next(assets, hand, 1, budget);
      const bool counts = contact.contact || (begin == 0 && tick < approach);
      touching -= counts ? 0 : 1;
      if (share(touching) <= beaten) return share(touching);
      plant.step({contact.force, contact.torque}, motion.next());
    }
    worst = std::min(worst, share(touching));
  }
  return worst;
}

Result<PlannedMotion> plan_tool(std::span<const AssetView* const> assets, const ToolTask& task) {
  ToolSettings settings = task.scene.tool.value_or(ToolSettings{});
  settings.spacing = 0;
  settings.samples =
      std::min(settings.samples > 0 ? settings.samples : planned_samples, planned_samples);
  ToolTask planned = task;
  planned.scene.tool = settings;
  auto tool = SampledTool::make(*assets[settings.asset], settings, 1, task.scene.objects.size());
  if (!tool) return tl::make_unexpected(std::move(tool.error()));
  Random random(task.seed);
  PlannedMotion best;
  for (std::size_t i = 0; i < task.scene.objects.size() && best.touching < good_share; ++i) {
    plan_on(assets, planned, **tool, i, random, best);
  }
  if (best.touching < 0) {
    return fail(ExitCode::invalid_input,
                "device sim: no object of the scene shows a surface for the tool to touch; bake it "
                "again with a larger --margin, or give the hand its way with "
                "sim:hand=path,path=FILE");
  }
  return best;
}

}  // namespace spm::servo
