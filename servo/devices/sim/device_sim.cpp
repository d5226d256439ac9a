// SPDX-License-Identifier: Apache-2.0
#include "servo/devices/sim/device_sim.hpp"

#include <limits>
#include <vector>

#include "common/base/device_profile.hpp"
#include "formats/motion/trajectory.hpp"
#include "servo/base/clock.hpp"
#include "servo/devices/sim/hand_planner.hpp"

namespace spm::servo {

namespace {

Result<HandMotion> recorded_hand(const std::string& path, double period) {
  const auto rows = read_trajectory(path);
  if (!rows) return tl::make_unexpected(rows.error());
  if (rows->empty()) {
    return fail(ExitCode::invalid_input,
                path + ": has no row; write one position 'x y z' in metres a line");
  }
  std::vector<Vector3> positions;
  positions.reserve(rows->size());
  for (const TrajectorySample& row : *rows) positions.push_back(row.position);
  return HandMotion::recorded(std::move(positions), period);
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

const char* name_of(HandKind hand) {
  switch (hand) {
    case HandKind::slide:
      return "slide";
    case HandKind::push:
      return "push";
    case HandKind::recorded:
      return "path";
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
}

Result<void> DeviceSim::open(const DeviceSetup& setup) {
  const double period = 1 / setup.rate_hz;
  const PlantSettings plant = plant_of(options_, period);
  Result<HandMotion> hand;
  if (options_.hand == HandKind::recorded) {
    hand = recorded_hand(options_.path, period);
  } else {
    HandTask task;
    task.slide = options_.hand == HandKind::slide;
    task.depth = options_.depth;
    task.speed = options_.speed;
    task.seed = options_.seed;
    task.plant = plant;
    task.scene = setup.scene;
    hand = plan_hand(setup.assets, task);
  }
  if (!hand) return tl::make_unexpected(hand.error());
  hand_ = std::move(*hand);
  plant_ = SimPlant(plant);
  plant_.place(hand_.start());
  return {};
}

DeviceHealth DeviceSim::read(DeviceState& state) noexcept {
  read_ns_ = now_ns();
  state.position = plant_.measured_position();
  state.buttons = 0;
  return DeviceHealth::ok;
}

DeviceHealth DeviceSim::write(const Wrench& wrench) noexcept {
  if (read_ns_ != 0) report_to_command_.add(now_ns() - read_ns_);
  read_ns_ = 0;
  plant_.step(wrench.force, hand_.next());
  return DeviceHealth::ok;
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
          {"latency_us", {{"report_to_command", report_to_command_.json_us()}}}};
}

}  // namespace spm::servo
