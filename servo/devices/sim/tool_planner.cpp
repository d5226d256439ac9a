// SPDX-License-Identifier: Apache-2.0
#include "servo/devices/sim/tool_planner.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <memory>
#include <utility>
#include <vector>

#include "servo/devices/sim/surface_walk.hpp"

namespace spm::servo {

namespace {

constexpr int lines_tried = 256;
constexpr int plans_wanted = 6;               // in each round
constexpr double good_share = 0.9;            // of the worst second
constexpr double longest_walk = 0.1;          // m
constexpr std::size_t longest_trial = 6000;   // ticks
constexpr std::size_t planned_samples = 600;  // the plan needs no more of the tool
constexpr double share_of_thickness = 0.35;   // as the hand's planner for a point

/// How far the tool is turned from how the hand holds it at rest, at a place and while it slides.
constexpr double largest_lean = 0.35, lean_while_sliding = 0.15, swing = 0.3;  // rad
constexpr double swing_length = 0.03;                                          // m, of one swing
constexpr double turn_speed = 1;                                               // rad/s

/// To which depth the places must be firm, as a fraction of the full depth, in each round.
constexpr double rounds[] = {1, 0.25, 0};

struct Plan {
  PoseMotion motion;
  double score = -1;  ///< contact in the worst second, 0 to 1
};

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
    if (tool.samples().levels.empty()) {
      add_corners(*assets[task.scene.tool->asset], task.scene.tool->placement);
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
  /// A `full` tool has no samples: the corners of its box stand for it in a plan.
  void add_corners(const AssetView& tool, const Placement& placement) {
    const Extent extent = extent_of(tool);
    for (int corner = 0; corner < 8; ++corner) {
      const Vector3 part(corner & 1, (corner >> 1) & 1, (corner >> 2) & 1);
      places_.push_back(placement.to_world(extent.low + part.cwiseProduct(extent.size)));
    }
  }

  Placement object_, hand_;
  bool turns_;
  std::vector<Vector3> places_;  ///< of the tool, m of the world, the device's tool's frame
};

PoseMotion motion_from(const Reach& reach, const ToolTask& task, const Touch& start,
                       double firm_depth, Random& random) {
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
  settings.length = longest_walk;
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

/// Plans on one object, until a plan is good. `best` is the best of all plans so far.
void plan_on(std::span<const AssetView* const> assets, const ToolTask& task, SampledTool& tool,
             std::size_t which, Random& random, Plan& best) {
  const Reach reach(assets, task, tool, which);
  for (const double firm : rounds) {
    int plans = 0;
    for (int line = 0; line < lines_tried && plans < plans_wanted; ++line) {
      const auto touch = touch_from_outside(reach.asset, 0, random);
      if (!touch) continue;
      const double firm_depth = firm * reach.depth;
      if (!firm_below(reach.asset, 0, *touch, firm_depth)) continue;
      ++plans;
      PoseMotion motion = motion_from(reach, task, *touch, firm_depth, random);
      const double score = contact_share(assets, task, tool, motion,
                                         std::min(motion.cycle_ticks(), longest_trial), best.score);
      if (score > best.score) best = {std::move(motion), score};
      if (best.score >= good_share) return;
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
      const ContactForce contact = force.next(assets, hand);
      const bool counts = contact.contact || (begin == 0 && tick < approach);
      touching -= counts ? 0 : 1;
      if (share(touching) <= beaten) return share(touching);
      plant.step({contact.force, contact.torque}, motion.next());
    }
    worst = std::min(worst, share(touching));
  }
  return worst;
}

Result<PoseMotion> plan_tool(std::span<const AssetView* const> assets, const ToolTask& task) {
  ToolSettings settings = task.scene.tool.value_or(ToolSettings{});
  settings.spacing = 0;
  settings.samples =
      std::min(settings.samples > 0 ? settings.samples : planned_samples, planned_samples);
  ToolTask planned = task;
  planned.scene.tool = settings;
  auto tool = SampledTool::make(*assets[settings.asset], settings, 1, task.scene.objects.size());
  if (!tool) return tl::make_unexpected(std::move(tool.error()));
  Random random(task.seed);
  Plan best;
  for (std::size_t i = 0; i < task.scene.objects.size() && best.score < good_share; ++i) {
    plan_on(assets, planned, **tool, i, random, best);
  }
  if (best.score < 0) {
    return fail(ExitCode::invalid_input,
                "device sim: no object of the scene shows a surface for the tool to touch; bake it "
                "again with a larger --margin, or give the hand its way with "
                "sim:hand=path,path=FILE");
  }
  return best.motion;
}

}  // namespace spm::servo
