// SPDX-License-Identifier: Apache-2.0
#include "servo/devices/sim/device_sim.hpp"

#include <spdlog/spdlog.h>

#include <limits>
#include <utility>
#include <vector>

#include "common/base/device_profile.hpp"
#include "formats/motion/trajectory.hpp"
#include "servo/base/clock.hpp"
#include "servo/devices/sim/hand_planner.hpp"
#include "servo/devices/sim/tool_planner.hpp"

namespace spm::servo {

namespace {

/// How far before an object a hand waits that is to be led, in diagonals of the object's box: out
/// of the box, and of a tool's that is as large.
constexpr double clear_share = 1.0;
/// Of a second, for which a hand that holds a tool is to touch.
constexpr double least_touching = 0.6;

/// `turns`: whether the hand follows the turns of the rows as well.
Result<PoseMotion> recorded_hand(const std::string& path, bool turns, double period) {
  auto rows = read_trajectory(path);
  if (!rows) return tl::make_unexpected(std::move(rows.error()));
  if (rows->empty()) {
    return fail(ExitCode::invalid_input,
                path +
                    ": has no row; write one position 'x y z' in metres a line, or a pose 'x y z "
                    "qw qx qy qz'");
  }
  std::vector<HandPose> poses;
  poses.reserve(rows->size());
  for (const TrajectorySample& row : *rows) {
    poses.push_back(unturned(row.position));
    if (turns) poses.back().orientation = Eigen::Quaterniond(row.qw, row.qx, row.qy, row.qz);
  }
  return PoseMotion::recorded(std::move(poses), period);
}

PlantSettings plant_of(const SimOptions& options, double period) {
  PlantSettings plant;
  plant.profile = *options.profile;
  plant.period = period;
  plant.hand = options.hand_model;
  plant.mass = options.mass;
  plant.delay_ticks = options.delay_ticks;
  plant.jitter = options.jitter_ticks * period;
  plant.lost_share = options.lost_share;
  plant.noise = options.noise;
  plant.seed = options.seed;
  plant.substeps = substeps_for(period);
  return plant;
}

/// The same device where it turns.
SixdofSettings turning_plant_of(const PlantSettings& plant, bool torque) {
  SixdofSettings turning;
  turning.profile = plant.profile;
  turning.period = plant.period;
  turning.substeps = plant.substeps;
  turning.delay_ticks = plant.delay_ticks;
  turning.hand = plant.hand;
  turning.jitter = plant.jitter;
  turning.lost_share = plant.lost_share;
  turning.noise = plant.noise;
  turning.seed = plant.seed;
  if (!torque) turning.torque_lever = 0;
  return turning;
}

Eigen::Isometry3d pose_of(const HandPose& hand) {
  Eigen::Isometry3d pose = Eigen::Isometry3d::Identity();
  pose.translation() = hand.position;
  pose.linear() = hand.orientation.toRotationMatrix();
  return pose;
}

/// A place in front of the scene's first object, towards the user, from where a hand sees it whole;
/// m, the hand's frame.
Vector3 before_object(const DeviceSetup& setup) {
  const PlacedObject& object = setup.scene.objects.front();
  const Extent extent = extent_of(*setup.assets[object.asset]);
  const Vector3 middle = object.placement.to_world(extent.low + extent.size / 2);
  const double size = object.placement.scale * extent.size.norm();
  return setup.scene.workspace.from_world(middle + size * clear_share * Vector3::UnitZ());
}

const char* name_of(HandKind hand) {
  switch (hand) {
    case HandKind::slide:
      return "slide";
    case HandKind::push:
      return "push";
    case HandKind::recorded:
      return "path";
    case HandKind::live:
      return "live";
  }
  return "";
}

}  // namespace

DeviceSim::DeviceSim(const SimOptions& options)
    : options_(options),
      capabilities_(capabilities_of("sim", *find_device_profile(options.profile->name))),
      plant_(plant_of(options, 1e-3)) {
  // The simulation is meant for stiffnesses that a real device could not render stably. Its hand
  // goes wherever the scene's objects lie.
  capabilities_.stiffness_cap = std::numeric_limits<double>::infinity();
  capabilities_.workspace.setZero();
  capabilities_.led = options.hand == HandKind::live;
}

Result<void> DeviceSim::open(const DeviceSetup& setup) {
  const PlantSettings plant = plant_of(options_, 1 / setup.rate_hz);
  const DeviceProfile& profile = *find_device_profile(options_.profile->name);
  capabilities_.turns = options_.turns.value_or(setup.scene.tool || options_.torque == true);
  const bool torque = capabilities_.turns && options_.torque.value_or(true);
  capabilities_.torque_cap = torque ? profile.torque_cap() : 0;
  capabilities_.turn_step = capabilities_.turns ? profile.turn_step() : 0;
  capabilities_.turning_inertia = profile.turning_inertia();
  capabilities_.own_delay = options_.delay_ticks / setup.rate_hz;
  auto planned = plan(setup);
  if (!planned) return tl::make_unexpected(std::move(planned.error()));
  motion_ = std::move(*planned);
  led_ = LedMotion(motion_.start(), plant.period);
  leading_.reset();
  plant_ = SimPlant(plant);
  plant_.place(motion_.start().position);
  if (!capabilities_.turns) return {};
  turning_.emplace(turning_plant_of(plant, torque));
  turning_->place(pose_of(motion_.start()));
  return {};
}

/// What the hand does in the scene.
Result<PoseMotion> DeviceSim::plan(const DeviceSetup& setup) const {
  const PlantSettings plant = plant_of(options_, 1 / setup.rate_hz);
  if (options_.hand == HandKind::recorded) {
    return recorded_hand(options_.path, capabilities_.turns, plant.period);
  }
  if (options_.hand == HandKind::live) {
    const Vector3 place = before_object(setup);
    return PoseMotion::press({unturned(place)}, {}, plant.period);
  }
  const auto set = [&](auto task) {
    task.slide = options_.hand == HandKind::slide;
    task.depth = options_.depth;
    task.speed = options_.speed;
    task.seed = options_.seed;
    task.scene = setup.scene;
    return task;
  };
  if (!setup.scene.tool) {
    auto task = set(HandTask{});
    task.plant = plant;
    return plan_hand(setup.assets, task);
  }
  auto task = set(ToolTask{});
  task.plant = turning_plant_of(plant, capabilities_.torque_cap > 0);
  task.turning = hand_turning(capabilities_);
  auto planned = plan_tool(setup.assets, task);
  if (!planned) return tl::make_unexpected(std::move(planned.error()));
  if (planned->touching < least_touching) {
    spdlog::warn(
        "device sim: no way was found on which the tool touches an object in at least {:.0f} % of "
        "each second, the best of those tried does in {:.0f} %; take another seed or depth, or "
        "give the hand its way with sim:hand=path,path=FILE",
        100 * least_touching, 100 * planned->touching);
  }
  return std::move(planned->motion);
}

DeviceHealth DeviceSim::read(DeviceState& state) noexcept {
  read_ns_ = now_ns();
  state.buttons = 0;
  if (!turning_) {
    state.position = plant_.measured_position();
    return DeviceHealth::ok;
  }
  const Eigen::Isometry3d measured = turning_->measured_pose();
  state.position = measured.translation();
  state.orientation = Eigen::Quaterniond(measured.linear()).normalized();
  return DeviceHealth::ok;
}

DeviceHealth DeviceSim::write(const Wrench& wrench) noexcept {
  if (read_ns_ != 0) report_to_command_.add(now_ns() - read_ns_);
  read_ns_ = 0;
  const SixdofTarget wanted =
      capabilities_.led ? led_.next(leading_.value_or(tool())) : motion_.next();
  if (turning_) {
    turning_->step(wrench, wanted);
  } else {
    plant_.step(wrench.force, {wanted.position, wanted.velocity});
  }
  return DeviceHealth::ok;
}

void DeviceSim::lead(const HandPose* target) noexcept {
  leading_ = target != nullptr ? std::optional(*target) : std::nullopt;
}

/// Where the tool truly is.
HandPose DeviceSim::tool() const noexcept {
  if (!turning_) return unturned(plant_.position());
  return {turning_->pose().translation(), Eigen::Quaterniond(turning_->pose().linear())};
}

nlohmann::ordered_json DeviceSim::describe() const {
  return {{"profile", options_.profile->name},
          {"hand", name_of(options_.hand)},
          {"depth_m", options_.depth},
          {"speed_m_s", options_.speed},
          {"seed", options_.seed},
          {"hand_model", options_.hand_model == HandModel::arm ? "arm" : "spring"},
          {"mass", options_.mass == MovingMass::constant ? "constant" : "device"},
          {"delay_ticks", options_.delay_ticks},
          {"jitter_ticks", options_.jitter_ticks},
          {"lost_share", options_.lost_share},
          {"noise_m", options_.noise},
          {"turns", capabilities_.turns},
          {"torque_cap_nm", capabilities_.torque_cap},
          {"latency_us", {{"report_to_command", report_to_command_.json_us()}}}};
}

}  // namespace spm::servo
