// SPDX-License-Identifier: Apache-2.0
#include "servo/devices/sim/device_sim.hpp"

#include <limits>
#include <vector>

#include "common/device_profile.hpp"
#include "formats/trajectory.hpp"
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
      dynamics_(*options.profile, 1e-3) {
  // What a real one could not render stably is to be tried here; and its hand goes wherever the
  // scene's objects lie.
  capabilities_.stiffness_cap = std::numeric_limits<double>::infinity();
  capabilities_.workspace.setZero();
}

Result<void> DeviceSim::open(const DeviceSetup& setup) {
  const double period = 1 / setup.rate_hz;
  Result<HandMotion> hand;
  if (options_.hand == HandKind::recorded) {
    hand = recorded_hand(options_.path, period);
  } else {
    HandTask task;
    task.slide = options_.hand == HandKind::slide;
    task.depth = options_.depth;
    task.speed = options_.speed;
    task.seed = options_.seed;
    task.period = period;
    task.scene = setup.scene;
    hand = plan_hand(setup.assets, task, *options_.profile);
  }
  if (!hand) return tl::make_unexpected(hand.error());
  hand_ = std::move(*hand);
  dynamics_ = SimDynamics(*options_.profile, period);
  dynamics_.place(hand_.start());
  return {};
}

DeviceHealth DeviceSim::read(DeviceState& state) noexcept {
  state.position = dynamics_.measured_position();
  state.buttons = 0;
  return DeviceHealth::ok;
}

DeviceHealth DeviceSim::write(const Wrench& wrench) noexcept {
  dynamics_.step(wrench.force, hand_.next());
  return DeviceHealth::ok;
}

nlohmann::ordered_json DeviceSim::describe() const {
  return {{"profile", options_.profile->name},
          {"hand", name_of(options_.hand)},
          {"depth_m", options_.depth},
          {"speed_m_s", options_.speed},
          {"seed", options_.seed}};
}

}  // namespace spm::servo
